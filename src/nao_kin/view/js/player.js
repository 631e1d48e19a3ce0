// A motion: play, pause, scrub, speed, and its curves. Or the iterates of a solver, one by one.

const ITERATES_A_SECOND = 8;
const PATH_PIECES = 240; // straight pieces a path is drawn with at most
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
    this.motion.joints.forEach((joint, k) => setJoint(this.state.joints, values, joint, row[k]));
    return values;
  }

  // Numbers of the samples, rows of the same length, at a time: straight between two of them.
  between(rows, time) {
    const { times, iterates } = this.motion;
    if (times.length < 2 || iterates) return rows[iterates ? Math.round(time) : 0];
    let low = 0, k = times.length - 1; // the samples around the time
    while (k - low > 1) {
      const middle = low + k >> 1;
      if (times[middle] <= time) low = middle;
      else k = middle;
    }
    const share = Math.min(Math.max((time - times[k - 1]) / (times[k] - times[k - 1]), 0), 1);
    return rows[k].map((value, column) => rows[k - 1][column] + share * (value - rows[k - 1][column]));
  }

  // Pairs of joint and value at a time.
  pairs(time) {
    const values = this.between(this.motion.q, time);
    return this.motion.joints.map((joint, column) => [joint, values[column]]);
  }

  go(time) {
    this.pause();
    this.at(time);
  }

  at(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    if (this.motion.body) this.state.body = this.between(this.motion.body, this.time);
    this.state.assign(this.pairs(this.time), "play");
    this.tell();
  }

  tell() {
    const { iterates, starts } = this.motion;
    this.scrubber.value = String(this.time);
    const count = this.motion.times.length - 1, sample = Math.round(this.time);
    const which = sample === count ? "returned" : `iterate ${sample} of ${count}`;
    const start = starts && starts[count] ? `, start ${starts[sample]}` : ""; // where there were several
    this.clock.textContent = iterates ? which + start : `${this.time.toFixed(2)} / ${this.end.toFixed(2)} s`;
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
    const { tips, starts, times, body } = this.motion;
    const at = (sample) => (body ? body[sample] : identity());
    if (!tips.length) return;
    [...new Set(starts ?? [0])].forEach((run, k) => {
      const samples = times.map((_, sample) => sample).filter((sample) => !starts || starts[sample] === run);
      const step = Math.max(1, Math.ceil((samples.length - 1) / PATH_PIECES));
      const chosen = samples.filter((_, index) => index % step === 0 || index === samples.length - 1);
      const worlds = chosen.map((sample) => this.state.poses(this.values(sample), at(sample)).world);
      for (const chain of tips) {
        const { tip } = this.state.scene.chains[chain];
        marks.path(worlds.map((world) => origin(world[tip])), START_COLOURS[k % START_COLOURS.length]);
      }
    });
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
    const rate = (column, k) => (q[k + 1][column] - q[k][column]) / (times[k + 1] - times[k]);
    const speed = (column) => middle.map((_, k) => factor * rate(column, k));
    const series = (x, y) => same.map((column) => ({ name: name(column), colour: colour(column), x, y: y(column) }));
    const value = {
      title: only < 0 ? "joint values" : `${name(only)}, value`, unit: units.unit(slides),
      limits: bounds([lower, upper]), series: series(times, (column) => q.map((sample) => factor * sample[column])),
    };
    if (times.length < 2) return [value];
    return [value, {
      title: "speed", unit: `${units.unit(slides)}/s`,
      limits: bounds(velocity === null ? [] : [velocity, -velocity]), series: series(middle, speed),
    }];
  }
}
