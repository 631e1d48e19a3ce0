// Postures in and out: as JSON, joint name to radians or metres.

class Exchange {
  constructor(state) {
    this.state = state;
    this.text = el("textarea", { id: "posture-text", spellcheck: false, rows: 12 });
    this.text.setAttribute("aria-label", "Posture as JSON");
    this.told = el("ul", { id: "posture-errors" });
    this.title = el("h2", {});
    this.apply = button("Apply", "Set the joints", () => this.read(), "primary");
    this.dialog = el("dialog", { class: "dialog" }, this.title,
      el("p", {}, "Joint names and values in radians, or metres for joints that slide."), this.text, this.told,
      el("div", { class: "buttons" }, this.apply, button("Close", "Close", () => this.dialog.close())));
    document.body.append(this.dialog);
    this.element = el("div", { class: "tools" },
      button("Reset", "Back to the first posture (r)", () => this.reset()),
      button("Copy posture", "Copy the joints as JSON", () => this.copy()),
      button("Paste posture", "Set the joints from JSON", () => this.paste()));
    this.element.lastChild.id = "paste";
    this.element.children[1].id = "copy";
    this.element.firstChild.id = "reset-posture";
  }

  reset() {
    this.state.body = identity();
    this.state.assume(this.state.first, "reset");
  }

  get json() {
    // By hand: as an object's keys, names such as __proto__ would be lost.
    const lines = this.state.joints.map(({ name }, k) => `  ${JSON.stringify(name)}: ${this.state.values[k]}`);
    return `{\n${lines.join(",\n")}\n}`;
  }

  async copy() {
    const text = this.json, said = this.element.children[1];
    try {
      await navigator.clipboard.writeText(text);
      said.textContent = "Copied";
      setTimeout(() => { said.textContent = "Copy posture"; }, 1500);
    } catch { // a page in a frame may not write there
      this.open("Copy this posture", text);
      this.text.select();
    }
  }

  paste() {
    this.open("Paste a posture", "");
    this.text.focus();
  }

  open(title, text) {
    this.title.textContent = title;
    this.text.value = text;
    this.told.replaceChildren();
    this.dialog.showModal();
  }

  read() {
    const { pairs, errors } = readPosture(this.text.value, this.state.joints);
    this.told.replaceChildren(...errors.map((error) => el("li", {}, error)));
    if (errors.length) return;
    this.state.assign(pairs, "paste");
    this.dialog.close();
  }
}

// Pairs of joint and value out of JSON text, and what is wrong with it.
function readPosture(text, joints) {
  let given;
  try {
    given = JSON.parse(text);
  } catch (error) {
    return { pairs: [], errors: [`This is not JSON: ${error.message}.`] };
  }
  if (given === null || typeof given !== "object" || Array.isArray(given)) {
    return { pairs: [], errors: ["Expected an object of joint names and numbers, as {\"LElbowRoll\": -0.5}."] };
  }
  const number = new Map(joints.map(({ name }, index) => [name, index]));
  const pairs = [], errors = [], values = new Map();
  for (const [name, value] of Object.entries(given)) {
    const joint = number.get(name);
    if (joint === undefined) errors.push(`There is no joint ${name}.`);
    else if (typeof value !== "number" || !Number.isFinite(value)) errors.push(`${name}: ${value} is not a number.`);
    else values.set(joint, value);
  }
  for (const [joint, value] of values) {
    const { leader, multiplier, offset, name } = joints[joint];
    if (leader >= 0 && values.has(leader)) {
      const wanted = multiplier * values.get(leader) + offset;
      if (Math.abs(wanted - value) > 1e-9) errors.push(`${name} follows ${joints[leader].name}: it must be ${wanted}.`);
    }
    pairs.push([joint, value]);
  }
  return { pairs, errors };
}
