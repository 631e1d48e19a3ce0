// Curves over time or iterates, as SVG.

const SVG = "http://www.w3.org/2000/svg";
const CURVE_COLOURS = ["#2f6fd6", "#d9640f", "#2f9e44", "#b5179e", "#0d8f9f", "#a67c00", "#d63b3b", "#7a4fd0"];
const CHART = { height: 112, left: 50, right: 10, top: 18, bottom: 18, points: 700 };

function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

// About `count` round numbers between two.
function ticks(low, high, count) {
  const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= rough) ?? rough;
  const found = [];
  for (let value = Math.ceil(low / step) * step; value <= high + 1e-9 * step; value += step) found.push(value);
  return found;
}

class Chart {
  // series: [{ name, colour, x, y }], y with nulls where there is nothing; limits: [{ name, value }].
  constructor({ title, series, limits = [], logarithmic = false, unit = "", width = 480, onscrub = null }) {
    Object.assign(this, { series, logarithmic, width });
    const { height, left, right, top, bottom } = CHART;
    const shown = (y) => (y === null || (logarithmic && y <= 0) ? null : logarithmic ? Math.log10(y) : y);
    const xs = series.flatMap(({ x }) => [x[0], x[x.length - 1]]);
    const ys = [...series.flatMap(({ y }) => y.map(shown)), ...limits.map(({ value }) => shown(value))]
      .filter((y) => y !== null);
    this.low = ys.reduce((a, b) => Math.min(a, b), Infinity);
    this.high = ys.reduce((a, b) => Math.max(a, b), -Infinity);
    if (!ys.length) [this.low, this.high] = [0, 1];
    const margin = 0.06 * (this.high - this.low) || (logarithmic ? 0.5 : 1e-3);
    this.low -= margin;
    this.high += margin;
    [this.start, this.end] = [Math.min(...xs), Math.max(...xs)];
    if (this.end === this.start) this.end = this.start + 1;
    this.x = (value) => left + (value - this.start) / (this.end - this.start) * (width - left - right);
    this.y = (value) => height - bottom - (value - this.low) / (this.high - this.low) * (height - top - bottom);
    this.cursor = svg("line", { class: "cursor", y1: top, y2: height - bottom });
    this.element = svg("svg", { class: "chart", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title },
      svg("text", { class: "title", x: left, y: 11 }), ...this.grid(unit),
      ...limits.map(({ value }) => svg("line", {
        class: "bound", x1: left, x2: width - right, y1: this.y(shown(value)), y2: this.y(shown(value)),
      })),
      ...series.map(({ x, y, colour }) =>
        svg("path", { class: "curve", stroke: colour, d: this.path(x, y.map(shown)) })),
      this.cursor);
    this.element.firstChild.textContent = unit ? `${title} [${unit}]` : title;
    if (onscrub) this.element.addEventListener("pointerdown", (event) => this.scrub(event, onscrub));
  }

  grid() {
    const { height, left, right, bottom } = CHART, { width } = this;
    const power = (value) => (Number.isInteger(value) ? `1e${value}` : "");
    const lines = [];
    for (const value of ticks(this.low, this.high, 4)) {
      const text = svg("text", { class: "tick", x: left - 6, y: this.y(value) + 3.5, "text-anchor": "end" });
      text.textContent = this.logarithmic ? power(Math.round(value * 1e6) / 1e6) : shortened(value, 6);
      const y = this.y(value);
      lines.push(svg("line", { class: "grid", x1: left, x2: width - right, y1: y, y2: y }), text);
    }
    for (const value of ticks(this.start, this.end, 6)) {
      const text = svg("text", { class: "tick", x: this.x(value), y: height - bottom + 13, "text-anchor": "middle" });
      text.textContent = shortened(value, 6);
      lines.push(text);
    }
    return lines;
  }

  // Of many samples the highest and lowest of each stretch are kept, so that no peak is lost.
  path(x, y) {
    const stretch = Math.max(1, Math.ceil(2 * x.length / CHART.points));
    let d = "", pen = "M";
    for (let i = 0; i < x.length; i += stretch) {
      const here = [];
      for (let k = i; k < Math.min(i + stretch, x.length); k++) if (y[k] !== null) here.push(k);
      if (!here.length) {
        pen = "M";
        continue;
      }
      const low = here.reduce((a, b) => (y[b] < y[a] ? b : a)), high = here.reduce((a, b) => (y[b] > y[a] ? b : a));
      for (const k of new Set(stretch > 1 ? [low, high].sort((a, b) => a - b) : [i])) {
        d += `${pen}${this.x(x[k]).toFixed(1)} ${this.y(y[k]).toFixed(1)}`;
        pen = "L";
      }
    }
    return d;
  }

  point(at) {
    const x = this.x(at).toFixed(1);
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
  }

  scrub(event, onscrub) {
    const move = ({ clientX }) => {
      const box = this.element.getBoundingClientRect();
      const x = (clientX - box.left) / box.width * this.width;
      const share = (x - CHART.left) / (this.width - CHART.left - CHART.right);
      onscrub(this.start + Math.min(Math.max(share, 0), 1) * (this.end - this.start));
    };
    const stop = () => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", stop);
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", stop);
    move(event);
  }
}
