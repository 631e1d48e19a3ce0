// What is drawn, in which units, in which colours; and the keyboard.

const KEYS = [
  ["space", "play or pause"], ["f", "frame the robot"], ["r", "first posture"], ["u", "degrees or radians"],
  ["x", "frames"], ["a", "joint axes"], ["l", "labels"], ["g", "ground"], ["b", "collision shapes"], ["c", "curves"],
  ["t", "dark or light"], ["p", "panel"], ["?", "this list"], ["← →", "on a slider: a small step"],
];

class Toolbar {
  // switches: [{ id, key, text, on, change }], each a checkbox in the menu.
  constructor(switches, actions) {
    this.actions = actions;
    this.boxes = switches.map((each) => {
      const box = checkbox(each.text, each.on, each.change);
      box.input.id = each.id;
      box.label.append(el("kbd", {}, each.key));
      return { ...each, ...box };
    });
    const menu = el("details", { id: "view" }, el("summary", { class: "button" }, "View ▾"),
      el("div", { class: "menu" }, ...this.boxes.map(({ label }) => label)));
    document.addEventListener("pointerdown", (event) => { if (!menu.contains(event.target)) menu.open = false; });
    this.unit = button("deg", "Degrees or radians (u)", () => this.switchUnits());
    this.unit.id = "units";
    this.theme = button("◐", "Dark or light (t)", () => this.switchTheme());
    this.theme.id = "theme";
    this.theme.setAttribute("aria-label", "Dark or light");
    this.help = el("dialog", { class: "dialog", id: "help" }, el("h2", {}, "Keys"),
      el("dl", {}, ...KEYS.flatMap(([key, does]) => [el("dt", {}, el("kbd", {}, key)), el("dd", {}, does)])),
      el("p", {}, "Drag turns the view, two fingers or the wheel zoom, the right button or shift moves it."),
      el("div", { class: "buttons" }, button("Close", "Close", () => this.help.close())));
    document.body.append(this.help);
    const frame = button("Frame", "Frame the robot (f)", actions.frame);
    frame.id = "frame";
    const ask = button("?", "Keys (?)", () => this.help.showModal());
    ask.setAttribute("aria-label", "Keys");
    ask.id = "keys";
    this.element = el("nav", { id: "toolbar" }, menu, this.unit, this.theme, frame, ask);
    this.element.setAttribute("aria-label", "View");
    const darkness = window.matchMedia("(prefers-color-scheme: dark)");
    darkness.addEventListener("change", () => this.setDark(darkness.matches));
    this.setDark(darkness.matches);
    document.addEventListener("keydown", (event) => this.key(event));
  }

  get isDark() {
    return document.documentElement.dataset.theme === "dark";
  }

  // As the system has it, or as somebody chose since: whichever comes last.
  setDark(dark) {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    this.actions.dark(dark);
  }

  switchUnits() {
    units.set(!units.degrees);
    this.unit.textContent = units.degrees ? "deg" : "rad";
  }

  switchTheme() {
    this.setDark(!this.isDark);
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || keepsKeys(event.target)) return;
    if (document.querySelector("dialog[open]")) return;
    const { target, key } = event;
    const own = target instanceof HTMLButtonElement || target.tagName === "SUMMARY" ||
      (target instanceof HTMLInputElement && ["checkbox", "radio"].includes(target.type));
    const box = this.boxes.find((each) => each.key === key.toLowerCase());
    const plain = {
      f: this.actions.frame, r: this.actions.reset, p: this.actions.panel, c: this.actions.curves,
      u: () => this.switchUnits(), t: () => this.switchTheme(), "?": () => this.help.showModal(),
    };
    if (key === " " && !own) this.actions.play();
    else if (box) box.input.click();
    else if (plain[key.toLowerCase()]) plain[key.toLowerCase()]();
    else return;
    if (key !== " " || !own) event.preventDefault();
  }
}
