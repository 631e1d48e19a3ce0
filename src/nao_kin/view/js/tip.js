// Where a tip is: the pose of a frame in another one, and what is missing to its target.

class TipPanel {
  constructor(state, goals) {
    this.state = state;
    this.goals = goals;
    const { nodes, chains } = state.scene;
    this.frames = nodes.flatMap((node, index) => (node.label ? [{ name: node.label, index }] : []));
    const names = this.frames.map((frame) => frame.name);
    this.chain = choice([...chains.map((chain) => chain.name), "between two frames"], "Chain", () => this.choose());
    this.chain.id = "chain";
    this.base = choice(names, "Base frame", () => this.free());
    this.tip = choice(names, "Tip frame", () => this.free());
    this.base.id = "base";
    this.tip.id = "tip-frame";
    this.position = ["x", "y", "z"].map((name) => el("output", { id: `tip-${name}` }));
    this.angles = ["roll", "pitch", "yaw"].map((name) => el("output", { id: `tip-${name}` }));
    this.unit = el("span", { class: "unit" });
    this.residuals = el("div", { class: "residuals" });
    state.listen(() => this.follow());
    units.listeners.push(() => this.follow());
    this.element = section("Tip pose", el("div", { class: "tip" },
      el("label", { class: "field" }, el("span", {}, "chain"), this.chain),
      el("label", { class: "field" }, el("span", {}, "base"), this.base),
      el("label", { class: "field" }, el("span", {}, "tip"), this.tip),
      row(["x", "y", "z"], this.position, el("span", { class: "unit" }, "m")),
      row(["roll", "pitch", "yaw"], this.angles, this.unit), this.residuals), { id: "tip-pose" });
    const { motion } = state.scene;
    this.chain.value = String(motion?.tips[0] ?? goals[0]?.goal.chain ?? 0);
    this.choose();
  }

  choose() {
    const chain = this.state.scene.chains[Number(this.chain.value)];
    if (chain) {
      this.base.value = String(this.frames.findIndex((frame) => frame.index === chain.base));
      this.tip.value = String(this.frames.findIndex((frame) => frame.index === chain.tip));
    }
    this.follow();
  }

  free() {
    this.chain.value = String(this.state.scene.chains.length);
    this.follow();
  }

  get ends() {
    return [this.base, this.tip].map((select) => this.frames[Number(select.value)].index);
  }

  // T_base_tip of the frames chosen.
  get pose() {
    return this.state.between(...this.ends);
  }

  follow() {
    const pose = this.pose;
    origin(pose).forEach((value, k) => { this.position[k].textContent = fixed(value, 6); });
    rollPitchYaw(pose).forEach((value, k) => { this.angles[k].textContent = units.angle(value); });
    this.unit.textContent = units.unit(false);
    this.residuals.replaceChildren(...this.goals.map((goal) => el("p", {}, goal.sentence(this.state))));
  }
}

function row(names, outputs, unit) {
  const cells = names.map((name, k) => el("span", { class: "cell" }, el("span", { class: "of" }, name), outputs[k]));
  return el("div", { class: "numbers" }, ...cells, unit);
}

// A target: what the tip misses of it, in numbers and as arrows.
class GoalMarks {
  constructor(marks, labels, state, goal) {
    Object.assign(this, { marks, state, goal, chain: state.scene.chains[goal.chain] });
    this.drawn = Boolean(marks);
    if (!this.drawn) return;
    this.frame = marks.frame(0.11 * marks.size, 1.6 * marks.thin);
    this.tipFrame = marks.frame(0.08 * marks.size, marks.thin);
    this.place = marks.solid("ball", TARGET_COLOUR, 0.8);
    this.aim = marks.arrow(TARGET_COLOUR);
    this.pointer = marks.arrow(POINTER_COLOUR);
    this.missing = marks.arrow(RESIDUAL_COLOUR);
    this.turn = marks.arrow(0xb5179e);
    labels.add("target", () => ({ text: "target", point: this.point }));
    labels.add("residual", () => {
      const { position } = this.residual(this.state);
      const far = position && length(position) > 1e-5;
      return far ? { text: `${few(1e3 * length(position))} mm`, point: this.midway } : null;
    });
    labels.add("residual", () => {
      const { rotation } = this.residual(this.state);
      const far = rotation && length(rotation) > 1e-4;
      return far ? { text: `${units.angle(length(rotation))} ${units.unit(false)}`, point: this.turnEnd } : null;
    });
  }

  // What is missing to the target, in base axes: a position [m] and a turn [rad]; null where the target leaves it free.
  residual(state) {
    const { kind, placement, counts, tipAxis, baseAxis } = this.goal;
    const tip = state.between(this.chain.base, this.chain.tip);
    let position = null, rotation = null;
    if (kind !== "orientation") {
      position = minus(origin(placement), origin(tip)).map((value, k) => (counts[k] ? value : 0));
    }
    if (kind === "pointing") {
      const now = turned(tip, tipAxis), about = cross(now, baseAxis), sine = length(about);
      const angle = Math.atan2(sine, dot(now, baseAxis));
      rotation = scaled(sine > 1e-12 ? scaled(about, 1 / sine) : across(now), angle);
    } else if (kind !== "position") {
      const still = (m) => [...m.slice(0, 12), 0, 0, 0, 1];
      rotation = rotationVector(product(still(placement), inverse(still(tip))));
      rotation = rotation.map((value, k) => (counts[3 + k] ? value : 0));
    }
    return { position, rotation };
  }

  sentence(state) {
    const { position, rotation } = this.residual(state);
    const parts = [];
    if (position) parts.push(`${few(1e3 * length(position))} mm`);
    if (rotation) parts.push(`${few(length(rotation) * units.factor(false))}${units.degrees ? "°" : " rad"}`);
    return `${this.chain.name} is ${parts.join(" and ")} from its target.`;
  }

  follow(state) {
    if (!this.drawn) return;
    const { kind, placement, tipAxis, baseAxis } = this.goal, reach = 0.1 * this.marks.size;
    const base = state.world[this.chain.base], tip = state.world[this.chain.tip], at = origin(tip);
    const wanted = product(base, placement);
    if (kind === "orientation") [wanted[12], wanted[13], wanted[14]] = at;
    this.point = origin(wanted);
    this.frame(kind === "pose" || kind === "orientation" ? wanted : null);
    this.tipFrame(kind === "pose" || kind === "orientation" ? tip : null);
    this.marks.putBall(this.place, this.point, 0.012 * this.marks.size);
    if (kind === "pointing") {
      this.aim(this.point, plus(this.point, scaled(turned(base, baseAxis), reach)));
      this.pointer(at, plus(at, scaled(turned(tip, tipAxis), reach)));
    } else {
      this.aim(null);
      this.pointer(null);
    }
    const { position, rotation } = this.residual(state);
    const end = position && plus(at, turned(base, position));
    this.missing(end && at, end);
    this.midway = end && scaled(plus(at, end), 0.5);
    // The turn that is missing: along its axis, a turn of π as long as the target's axes.
    this.turnEnd = rotation && plus(at, turned(base, scaled(rotation, reach / Math.PI)));
    this.turn(rotation && length(rotation) > 1e-6 ? at : null, this.turnEnd);
  }
}
