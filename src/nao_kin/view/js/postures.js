// A list of postures to choose from: the one chosen is solid, the others are ghosts. Also the branches of a target.

const GHOST_COLOURS = [0x2f6fd6, 0xd9640f, 0x2f9e44, 0xb5179e, 0x0d8f9f, 0xa67c00, 0xd63b3b, 0x7a4fd0];

function hexadecimal(colour) {
  return `#${colour.toString(16).padStart(6, "0")}`;
}

class PosturePanel {
  constructor(state, stage, marks) {
    Object.assign(this, { state, stage, marks, postures: state.scene.postures });
    this.chosen = 0;
    this.ghosts = state.scene.ghosts && this.postures.length > 1;
    const columns = state.scene.columns;
    const head = el("tr", {}, el("th", { scope: "col", colSpan: 2 }, "posture"),
      ...columns.map((column) => el("th", { scope: "col" }, column)));
    this.radios = this.postures.map((posture, index) => el("input", {
      type: "radio", name: "posture", id: `p${index}`, checked: index === 0, onchange: () => this.choose(index),
    }));
    const rows = this.postures.map((posture, index) => this.row(posture, index));
    const switching = checkbox("the others as ghosts", this.ghosts, (checked) => {
      this.ghosts = checked;
      this.drawGhosts();
    });
    switching.input.id = "ghosts";
    state.listen((_, cause) => {
      if (cause === "joint") this.radios.forEach((radio) => { radio.checked = false; });
    });
    this.element = section("Postures", el("div", {},
      el("div", { class: "table" },
        el("table", { class: "postures" }, el("thead", {}, head), el("tbody", {}, ...rows))),
      this.postures.length > 1 ? switching.label : null), { id: "postures", count: this.postures.length });
    this.drawGhosts();
  }

  row(posture, index) {
    const swatch = el("span", { class: "swatch" });
    swatch.style.background = hexadecimal(GHOST_COLOURS[index % GHOST_COLOURS.length]);
    const kind = posture.good === null ? "" : posture.good ? "good" : "bad";
    return el("tr", { class: kind },
      el("td", { class: "pick" }, this.radios[index], swatch),
      el("th", { scope: "row" }, el("label", { htmlFor: `p${index}` }, posture.name)),
      ...posture.cells.map((cell) => el("td", {}, cell)));
  }

  choose(index) {
    this.chosen = index;
    this.state.assume(this.postures[index].values);
    this.drawGhosts();
  }

  drawGhosts() {
    if (!this.stage) return;
    const others = this.postures.flatMap((posture, index) => (index === this.chosen ? []
      : [{ values: posture.values, colour: GHOST_COLOURS[index % GHOST_COLOURS.length] }]));
    this.stage.setGhosts(this.state, this.marks, this.ghosts ? others : []);
  }
}
