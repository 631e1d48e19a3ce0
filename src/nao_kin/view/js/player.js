// A motion: play, pause, scrub, speed, and its curves. Or the iterates of a solver, one by one.

const ITERATES_A_SECOND = 8;
const START_COLOURS = [0x7a4fd0, 0x0d8f9f, 0xd9640f, 0x2f9e44];

class Player {
  constructor(state, marks) {
    Object.assign(this, { state, motion: state.scene.motion });
    const { times } = this.motion;
    [this.start, this.end] = [times[0], times[times.length - 1]];
    this.time = this.motion.iterates ? this.end : this.start;
    this.playing = false;
    this.play = button("▶", "Play (space)", () => this.toggle(), "play");
    this.play.id = "play";
    this.scrubber = el("input", { type: "range", id: "scrub", step: this.motion.iterates ? 1 : "any",
      oninput: () => this.go(Number(this.scrubber.value)) });
    this.scrubber.setAttribute("aria-label", this.motion.iterates ? "Iterate" : "Time");
    Object.assign(this.scrubber, { min: this.start, max: this.end });
    this.clock = el("output", { id: "clock" });
    this.speeds = [0.1, 0.25, 0.5, 1, 2, 4];
    this.speed = choice(this.speeds.map((speed) => `${speed}×`), "Speed", () => {});
    this.speed.value = "3";
    this.speed.id = "speed";
    this.loop = checkbox("loop", false, () => {});
    this.charts = [];
    this.curves = el("div", { id: "curves" });
    this.shownJoint = choice(["all joints", ...this.motion.joints.map((joint) => state.joints[joint].name)],
      "Joint of the curves", () => this.drawCurves());
    this.shownJoint.id = "curve-joint";
    const fold = button("Curves", "Show the curves (c)", () => this.fold());
    fold.id = "fold";
    this.element = el("section", { id: "player" }, this.curves,
      el("div", { class: "bar" }, this.play, this.scrubber, this.clock, this.speed, this.loop.label, fold));
    this.paths(marks);
    state.listen((_, cause) => { if (cause !== "play") this.pause(); });
    units.listeners.push(() => this.drawCurves());
    this.curves.hidden = window.innerHeight < 560 || window.innerWidth < 720;
    new ResizeObserver(() => this.drawCurves()).observe(this.element);
  }

  fold() {
    this.curves.hidden = !this.curves.hidden;
    this.drawCurves();
    if (this.onfold) this.onfold();
  }

  values(sample) {
    const values = [...this.state.first], row = this.motion.q[sample];
    const plain = { joints: this.state.joints, values };
    this.motion.joints.forEach((joint, k) => State.prototype.drive.call(plain, joint, row[k]));
    return values;
  }

  // Pairs of joint and value at a time.
  pairs(time) {
    const { times, q, joints, iterates } = this.motion;
    let low = 0, k = times.length - 1; // the samples around the time
    while (k - low > 1) {
      const middle = low + k >> 1;
      if (times[middle] <= time) low = middle;
      else k = middle;
    }
    if (times.length < 2 || iterates) {
      const sample = iterates ? Math.round(time) : 0;
      return joints.map((joint, column) => [joint, q[sample][column]]);
    }
    const share = Math.min(Math.max((time - times[k - 1]) / (times[k] - times[k - 1]), 0), 1);
    return joints.map((joint, column) => [joint, q[k - 1][column] + share * (q[k][column] - q[k - 1][column])]);
  }

  go(time) {
    this.pause();
    this.at(time);
  }

  at(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.state.assign(this.pairs(this.time), "play");
    this.tell();
  }

  tell() {
    const { iterates, starts } = this.motion;
    this.scrubber.value = String(this.time);
    const count = this.motion.times.length - 1, sample = Math.round(this.time);
    this.clock.textContent = !iterates ? `${this.time.toFixed(2)} / ${this.end.toFixed(2)} s`
      : `${sample === count ? "returned" : `iterate ${sample}`} of ${count}${starts && starts[count] ? `, start ${starts[sample]}` : ""}`;
    this.scrubber.setAttribute("aria-valuetext", this.clock.textContent);
    for (const chart of this.charts) chart.point(this.time);
  }

  toggle() {
    if (this.playing) {
      this.pause();
      return;
    }
    if (this.time >= this.end) this.at(this.start);
    this.playing = true;
    this.play.textContent = "❚❚";
    this.play.title = "Pause (space)";
    let last = null;
    const step = (now) => {
      if (!this.playing) return;
      const passed = last === null ? 0 : (now - last) / 1000;
      last = now;
      const rate = this.speeds[Number(this.speed.value)] * (this.motion.iterates ? ITERATES_A_SECOND : 1);
      let time = this.time + passed * rate;
      if (time >= this.end && this.loop.input.checked) time = this.start;
      this.at(time);
      if (this.time >= this.end) this.pause();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = false;
    this.play.textContent = "▶";
    this.play.title = "Play (space)";
  }

  // The paths of the tips; of a solver's iterates one for each start.
  paths(marks) {
    if (!marks) return;
    const { tips, starts, times } = this.motion;
    const worlds = times.map((_, sample) => this.state.poses(this.values(sample), identity()).world);
    for (const chain of tips) {
      const points = worlds.map((world) => origin(world[this.state.scene.chains[chain].tip]));
      const runs = [...new Set(starts ?? [0])];
      for (const run of runs) {
        const colour = START_COLOURS[runs.indexOf(run) % START_COLOURS.length];
        marks.path(starts ? points.filter((_, sample) => starts[sample] === run) : points, colour);
      }
    }
  }

  drawCurves() {
    if (this.curves.hidden) return;
    const specifications = this.motion.iterates ? this.errorCurves() : this.jointCurves();
    const room = this.curves.clientWidth || 900, beside = specifications.length > 1 && room > 620;
    const width = Math.max(beside ? room / 2 - 6 : room, 200);
    this.charts = specifications.map((one) => new Chart({ ...one, width, onscrub: (time) => this.go(time) }));
    const names = specifications[0].series.length > 1 || this.motion.iterates
      ? specifications.flatMap(({ series }, k) => (k && !this.motion.iterates ? [] : series)) : [];
    const legend = el("p", { class: "legend" }, ...names.map(({ name, colour }) => {
      const swatch = el("span", { class: "swatch" });
      swatch.style.background = colour;
      return el("span", { class: "key" }, swatch, name);
    }));
    this.curves.replaceChildren(
      ...(this.motion.iterates ? [] : [el("div", { class: "which" }, this.shownJoint)]),
      el("div", { class: beside ? "charts beside" : "charts" }, ...this.charts.map((chart) => chart.element)), legend);
    this.tell();
  }

  errorCurves() {
    const { times, curves } = this.motion;
    return curves.map(({ name, unit, y }, k) => ({
      title: name, unit, logarithmic: true,
      series: [{ name, colour: CURVE_COLOURS[k % CURVE_COLOURS.length], x: times, y }],
    }));
  }

  jointCurves() {
    const { times, q, joints } = this.motion;
    const only = Number(this.shownJoint.value) - 1;
    const columns = joints.map((_, column) => column).filter((column) => only < 0 || column === only);
    const slides = this.state.joints[joints[columns[0]]].slides, factor = units.factor(slides);
    const same = columns.filter((column) => this.state.joints[joints[column]].slides === slides);
    const colour = (column) => CURVE_COLOURS[column % CURVE_COLOURS.length];
    const name = (column) => this.state.joints[joints[column]].name;
    const { lower, upper, velocity } = this.state.joints[joints[columns[0]]];
    const bounds = (values) => (only < 0 ? [] : values.filter((value) => value !== null)
      .map((value) => ({ value: value * factor })));
    const middle = times.slice(1).map((time, k) => (time + times[k]) / 2);
    const speed = (column) => middle.map((_, k) => factor * (q[k + 1][column] - q[k][column]) / (times[k + 1] - times[k]));
    const value = {
      title: only < 0 ? "joint values" : `${name(only)}, value`, unit: units.unit(slides), limits: bounds([lower, upper]),
      series: same.map((column) => ({ name: name(column), colour: colour(column), x: times, y: q.map((r) => factor * r[column]) })),
    };
    if (times.length < 2) return [value];
    return [value, {
      title: "speed", unit: `${units.unit(slides)}/s`, limits: bounds([velocity, velocity === null ? null : -velocity]),
      series: same.map((column) => ({ name: name(column), colour: colour(column), x: middle, y: speed(column) })),
    }];
  }
}
