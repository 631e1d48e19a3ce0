// The joints: a slider and a number for each, by limb.

const ENDLESS = { turning: Math.PI, sliding: 1 }; // [rad, m] how far a slider goes where the joint has no limit

class JointRow {
  constructor(state, index) {
    Object.assign(this, { state, index, joint: state.joints[index] });
    const { name, slides, kind, leader } = this.joint;
    const id = `j${index}`;
    this.slider = el("input", { type: "range", id, step: "any", oninput: () => this.slide() });
    this.slider.setAttribute("aria-label", name);
    this.number = el("input", {
      type: "text", inputMode: "decimal", class: "number", autocomplete: "off",
      onchange: () => this.typed(), onfocus: () => this.number.select(),
    });
    this.number.setAttribute("aria-label", `${name}, value`);
    this.unit = el("span", { class: "unit" });
    this.lower = el("span", { class: "limit" });
    this.upper = el("span", { class: "limit upper" });
    this.remark = el("p", { class: "remark", hidden: true });
    const follows = leader < 0 ? null : el("span", { class: "tag" }, `follows ${state.joints[leader].name}`);
    const means = kind === "continuous" ? el("span", { class: "tag" }, "endless") : null;
    this.element = el("div", { class: "joint" },
      el("div", { class: "head" },
        el("label", { htmlFor: id, title: name }, name), follows, means, this.number, this.unit),
      el("div", { class: "track" }, this.lower, this.slider, this.upper), this.remark);
    const half = slides ? ENDLESS.sliding : ENDLESS.turning;
    const { lower, upper } = this.joint;
    this.slider.min = lower ?? (upper === null ? -half : Math.min(-half, upper - half));
    this.slider.max = upper ?? (lower === null ? half : Math.max(half, lower + half));
  }

  slide() {
    const [lower, upper] = this.state.range(this.index);
    let value = Number(this.slider.value);
    if (lower !== null) value = Math.max(value, lower);
    if (upper !== null) value = Math.min(value, upper);
    this.state.move(this.index, value);
  }

  typed() {
    const { slides } = this.joint;
    const value = numberIn(this.number.value) / units.factor(slides);
    const [lower, upper] = this.state.range(this.index);
    const inside = (lower === null || value >= lower - 1e-6) && (upper === null || value <= upper + 1e-6);
    if (Number.isFinite(value) && inside) {
      this.state.move(this.index, value);
      return;
    }
    const unit = units.unit(slides);
    this.say(Number.isFinite(value)
      ? `Not set: it may be ${units.limit(lower, slides) || "any"} to ${units.limit(upper, slides) || "any"} ${unit}.`
      : "Not set: this is not a number.");
    this.number.setAttribute("aria-invalid", "true");
  }

  say(text) {
    this.remark.hidden = !text;
    this.remark.textContent = text;
  }

  follow() {
    const { state, index } = this, { slides } = this.joint, value = state.values[index];
    const [lower, upper] = state.range(index);
    const outside = state.isOutside(index), held = state.held.get(index);
    this.slider.value = String(value);
    this.slider.setAttribute("aria-valuetext", `${units.joint(value, slides)} ${units.unit(slides)}`);
    this.number.value = units.joint(value, slides);
    this.number.removeAttribute("aria-invalid");
    this.unit.textContent = units.unit(slides);
    this.lower.textContent = units.limit(lower, slides);
    this.upper.textContent = units.limit(upper, slides);
    this.element.classList.toggle("outside", outside);
    this.say(outside ? "Outside its limits." : held === undefined ? "" :
      `Moved along: its range depends on ${state.joints[held].name}.`);
  }
}

class JointPanel {
  constructor(state, rows) {
    this.state = state;
    this.rows = rows;
    this.byJoint = new Map(rows.map((row) => [row.index, row]));
    state.listen(() => this.follow());
    units.listeners.push(() => this.follow());
    this.follow();
  }

  follow() {
    for (const row of this.rows) row.follow();
  }
}

function jointPanel(state, tools) {
  const rows = state.joints.map((_, index) => new JointRow(state, index));
  const groups = state.scene.groups.length ? state.scene.groups
    : [{ title: "joints", joints: rows.map((_, index) => index) }];
  const panel = new JointPanel(state, rows);
  // Open is what the page is about, else the first limb.
  const { motion, goals, nodes, chains } = state.scene;
  const about = new Set(motion ? motion.joints : []);
  for (const { chain } of goals) {
    for (let node = chains[chain].tip; node >= 0 && node !== chains[chain].base; node = nodes[node].parent) {
      if (nodes[node].drive) about.add(nodes[node].drive.joint);
    }
  }
  const touched = groups.flatMap(({ joints }, number) => (joints.some((index) => about.has(index)) ? [number] : []));
  const opened = touched.length ? touched : [0];
  const parts = groups.map(({ title, joints }, number) => {
    const content = el("div", { class: "rows" }, ...joints.map((index) => rows[index].element));
    return section(title, content, { open: opened.includes(number), count: joints.length });
  });
  return { panel, element: section("Joints", el("div", { class: "limbs" }, tools, ...parts),
    { id: "joints", count: rows.length }) };
}
