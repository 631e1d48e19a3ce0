// The body over feet that stay: six sliders, and the legs follow by their closed forms.

const REACHED = 1e-6; // [m]
const MISSED_COLOUR = 0xd61f2c;
const BODY_AXES = [
  { name: "x", id: "body-x", turns: false }, { name: "y", id: "body-y", turns: false },
  { name: "z", id: "body-z", turns: false }, { name: "roll", id: "body-roll", turns: true },
  { name: "pitch", id: "body-pitch", turns: true }, { name: "yaw", id: "body-yaw", turns: true },
];

class BodyPanel {
  constructor(state, stage) {
    Object.assign(this, { state, stage, legs: state.scene.legs });
    const { numbers } = this.legs[0];
    const reach = 0.6 * (numbers[LEG.femur] + numbers[LEG.tibia]), turn = Math.PI / 5;
    this.rows = BODY_AXES.map(({ name, id, turns }) => {
      const slider = el("input", { type: "range", id, step: "any", oninput: () => this.move() });
      Object.assign(slider, { min: turns ? -turn : -reach, max: turns ? turn : reach, value: 0 });
      slider.setAttribute("aria-label", `body ${name}`);
      return { name, turns, slider, value: el("output", {}) };
    });
    this.told = el("div", { id: "missed", role: "status" });
    const level = button("Level", "Body back to where it stood", () => this.level());
    level.id = "level";
    this.element = section("Body over its feet", el("div", { class: "body" },
      ...this.rows.map(({ name, slider, value }) =>
        el("label", { class: "field" }, el("span", {}, name), slider, value)),
      el("div", { class: "tools" }, level), this.told), { id: "body" });
    state.listen((_, cause) => { if (cause !== "body") this.stand(); });
    units.listeners.push(() => this.tell());
    this.stand();
  }

  // The feet are where they are now; the body's sliders count from here.
  stand() {
    const { world } = this.state;
    for (const row of this.rows) row.slider.value = "0";
    this.feet = this.legs.map(({ foot }) => origin(world[foot]));
    this.baseAtStart = world[this.legs[0].base];
    this.valuesAtStart = [...this.state.values];
    this.bodyAtStart = this.state.body;
    this.paint([]);
    this.tell();
  }

  level() {
    for (const row of this.rows) row.slider.value = "0";
    this.state.body = this.bodyAtStart;
    this.state.assume(this.valuesAtStart, "body");
    this.paint([]);
    this.tell();
  }

  move() {
    const numbers = this.rows.map(({ slider }) => Number(slider.value));
    const offset = fromPositionAndAngles(numbers.slice(0, 3), numbers.slice(3));
    const start = this.baseAtStart, upright = [...start.slice(0, 12), 0, 0, 0, 1];
    const place = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, ...origin(start), 1];
    const base = product(product(place, offset), upright); // T_ground_base
    const rootFromBase = product(inverse(this.state.world[this.legs[0].base]), this.state.body); // T_base_root
    this.state.body = product(base, rootFromBase);
    const pairs = [], toBase = inverse(base);
    const chosen = this.legs.map((leg, k) => this.solve(leg, acted(toBase, this.feet[k])));
    this.legs.forEach((leg, k) => leg.joints.forEach((joint, i) => pairs.push([joint, chosen[k].q[i]])));
    this.state.assign(pairs, "body");
    this.paint(chosen.flatMap(({ reason }, k) => {
      const miss = length(minus(origin(this.state.world[this.legs[k].foot]), this.feet[k]));
      if (!reason && miss <= REACHED) return [];
      return [{ leg: k, reason: reason || `its foot is ${few(1e3 * miss)} mm off` }];
    }));
    this.tell();
  }

  // The solution within limits nearest to the joints it stood with; else the one that comes nearest, and why. Where it
  // stands now does not count: the same sliders always mean the same joints.
  solve(leg, p) {
    const now = leg.joints.map((joint) => this.valuesAtStart[joint]);
    const ranges = leg.joints.map((joint) => this.state.range(joint));
    const lower = ranges.map(([end]) => end ?? -Infinity), upper = ranges.map(([, end]) => end ?? Infinity);
    const windings = (q) => q.map((value, k) => {
      const middle = (lower[k] + upper[k]) / 2 || 0; // 0 where there are no limits
      return Number.isFinite(middle) ? value + 2 * Math.PI * Math.round((middle - value) / (2 * Math.PI)) : value;
    });
    const excess = (q) => Math.max(0, ...q.map((value, k) => Math.max(lower[k] - value, value - upper[k])));
    const moved = (q) => Math.max(...q.map((value, k) => Math.abs(wrapped(value - now[k]))));
    const clipped = (q) => q.map((value, k) => Math.min(Math.max(value, lower[k]), upper[k]));
    const least = (list, cost) => list.reduce((best, q) => (cost(q) < cost(best) ? q : best));
    const found = legSolutions(leg.numbers, p).map(windings);
    const inside = found.filter((q) => excess(q) <= LIMIT_TOLERANCE);
    if (inside.length) return { q: least(inside, moved), reason: "" };
    if (found.length) return { q: clipped(least(found, excess)), reason: "it reaches its foot only beyond its limits" };
    const miss = legMissesBy(leg.numbers, p), far = `${few(1e3 * Math.abs(miss))} mm`;
    const nearest = legSolutions(leg.numbers, p, Infinity).map(windings).map(clipped);
    const reason = `its foot is ${far} too ${miss < 0 ? "near" : "far"}`;
    return { q: nearest.length ? least(nearest, moved) : now, reason };
  }

  paint(missed) {
    this.missed = missed;
    if (!this.stage) return;
    this.legs.forEach((leg, k) => {
      const own = this.nodesOf(leg);
      this.stage.paint(own, missed.some((one) => one.leg === k) ? MISSED_COLOUR : null);
    });
  }

  // The nodes from the first joint to the foot.
  nodesOf({ foot, joints }) {
    const { nodes } = this.state.scene, found = [foot];
    while (nodes[found.at(-1)].drive?.joint !== joints[0] && nodes[found.at(-1)].parent >= 0) {
      found.push(nodes[found.at(-1)].parent);
    }
    return found;
  }

  tell() {
    for (const { turns, slider, value } of this.rows) {
      const number = Number(slider.value);
      value.textContent = turns ? `${units.joint(number, false)} ${units.unit(false)}` : `${fixed(1e3 * number, 1)} mm`;
    }
    this.told.replaceChildren(...this.missed.map(({ leg, reason }) => el("p", { class: "bad" },
      `Leg ${this.legs[leg].name} cannot follow: ${reason}.`)));
  }
}
