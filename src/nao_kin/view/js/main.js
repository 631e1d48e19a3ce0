// Puts the page together.

const page = document.documentElement;
const pane = document.getElementById("pane");
const stagePlace = document.getElementById("stage");
const card = document.getElementById("card");
const NARROW = 640; // CSS pixels: below it the card is a sheet at the lower edge
const GAP = 8;

function unhappy(message) {
  const place = document.getElementById("trouble");
  place.textContent = message;
  place.hidden = false;
}

// The part of the stage, in CSS pixels, that neither card nor toolbar nor player covers.
function freePart() {
  const width = stagePlace.clientWidth, height = stagePlace.clientHeight;
  const box = card.getBoundingClientRect(), narrow = window.innerWidth <= NARROW;
  const bar = document.getElementById("toolbar"), player = document.getElementById("player");
  const left = narrow || !box.width ? 0 : box.right;
  let top = bar ? bar.getBoundingClientRect().bottom : 0;
  let bottom = narrow ? box.top : height;
  if (player && narrow) top = player.getBoundingClientRect().bottom;
  else if (player) bottom = player.getBoundingClientRect().top;
  const part = { x: left, y: top + GAP, width: width - left, height: bottom - top - 2 * GAP };
  return part.width > 60 && part.height > 60 ? part : { x: 0, y: 0, width, height };
}

function startViewer(commands) {
  try {
    const viewer = new MeshCat.Viewer(pane);
    viewer.gui.domElement.remove();
    for (const command of commands) viewer.handle_command_bytearray(command);
    return viewer;
  } catch (error) {
    unhappy("The picture cannot be drawn, which needs WebGL. The numbers are complete.");
    return null;
  }
}

function sizeOf(points) {
  let largest = 0;
  for (let axis = 0; axis < 3; axis++) {
    let low = Infinity, high = -Infinity;
    for (let i = axis; i < points.length; i += 3) {
      low = Math.min(low, points[i]);
      high = Math.max(high, points[i]);
    }
    largest = Math.max(largest, high - low);
  }
  return Math.max(largest, 1e-3);
}

// Everything that is drawn besides the robot, and the switches for it.
function drawExtras(stage, marks, labels, state, scene) {
  const named = scene.nodes.flatMap((node, index) => (node.label ? [index] : []));
  const framed = frameMarks(marks, scene.framed), frames = frameMarks(marks, named);
  const axes = jointAxisMarks(marks, scene);
  const rods = scene.rods.map((rod) => ({ ...rod, mesh: marks.solid("rod", rod.colour) }));
  const ends = ({ start, end }) => [origin(state.world[start]), origin(state.world[end])];
  for (const rod of rods.filter((each) => each.measured).reverse()) {
    labels.add("residual", () => {
      const [a, b] = ends(rod), gap = length(minus(b, a));
      return gap > 1e-6 ? { text: `${few(1e3 * gap)} mm`, point: scaled(plus(a, b), 0.5) } : null;
    });
  }
  let labelled = false;
  scene.nodes.forEach((node, index) => {
    if (!node.drive || !node.label) return;
    const text = scene.joints[node.drive.joint].name;
    labels.add("name", () => (labelled ? { text, point: origin(state.world[index]) } : null));
  });
  state.listen(() => {
    stage.show(state);
    for (const rod of rods) marks.stretch(rod.mesh, ...ends(rod), rod.radius);
    for (const each of [framed, frames, axes]) each.follow(state);
  });
  framed.show(scene.framed.length > 0, state);
  const dirty = (act) => (on) => {
    act(on);
    stage.viewer.set_dirty();
  };
  const switches = [
    { id: "frames", key: "x", text: "frames", on: false, change: dirty((on) => frames.show(on, state)) },
    { id: "axes", key: "a", text: "joint axes", on: false, change: dirty((on) => axes.show(on, state)) },
    { id: "labels", key: "l", text: "joint names", on: false, change: dirty((on) => { labelled = on; }) },
    { id: "ground", key: "g", text: "ground", on: true, change: dirty((on) => { stage.ground.visible = on; }) },
    { id: "collisions", key: "b", text: "collision shapes", on: false, change: dirty((on) => stage.setCollisions(on)) },
  ];
  if (!scene.framed.length) return switches;
  const change = dirty((on) => framed.show(on, state));
  return [{ id: "link-frames", key: "n", text: "frames of the chains", on: true, change }, ...switches];
}

function sheet(onchange) {
  const grip = document.getElementById("grip");
  const fold = () => {
    card.classList.toggle("folded");
    grip.setAttribute("aria-expanded", String(!card.classList.contains("folded")));
    onchange();
  };
  grip.addEventListener("click", fold);
  for (const part of card.querySelectorAll("details")) part.addEventListener("toggle", onchange);
  return fold;
}

async function start() {
  const { scene, commands } = await readScene();
  const viewer = startViewer(commands);
  const state = new State(scene);
  const stage = viewer && new Stage(viewer, scene);
  if (stage) stage.show(state);
  const marks = stage && new Marks(stage, sizeOf(pointsOf([stage.robot])));
  const labels = stage && new Labels(document.getElementById("words"), viewer);
  const switches = stage ? drawExtras(stage, marks, labels, state, scene) : [];
  const goals = scene.goals.map((goal) => new GoalMarks(marks, labels, state, goal));
  for (const goal of goals) state.listen(() => goal.follow(state));
  const exchange = new Exchange(state);
  const tip = scene.nodes.length ? new TipPanel(state, goals) : null;
  const parts = [];
  if (scene.postures.length) parts.push(new PosturePanel(state, stage, marks).element);
  if (scene.legs.length) parts.push(new BodyPanel(state, stage).element);
  if (tip) parts.push(tip.element);
  if (scene.joints.length) parts.push(jointPanel(state, exchange.element).element);
  document.getElementById("controls").append(...parts);
  const player = scene.motion ? new Player(state, marks) : null;
  if (player) document.body.append(player.element);
  finish({ viewer, state, stage, goals, tip, player, exchange, switches });
}

function finish({ viewer, state, stage, goals, tip, player, exchange, switches }) {
  const subjects = () => (stage ? [stage.robot, stage.marks, ...stage.ghosts.map(({ group }) => group)] : []);
  let man = null;
  const layOut = () => man && man.layOut();
  const fold = sheet(layOut);
  const toolbar = new Toolbar(switches, {
    frame: () => man && man.frame(),
    reset: () => exchange.reset(),
    panel: fold,
    play: () => player && player.toggle(),
    curves: () => player && player.fold(),
    dark: (dark) => stage && stage.setDark(dark),
  });
  document.body.append(toolbar.element);
  if (player) player.onfold = layOut;
  if (stage) {
    man = new CameraMan(viewer, stagePlace, freePart, subjects);
    preparePrinting(viewer, pane);
  }
  state.changed("start");
  if (player && !player.motion.iterates) player.at(player.start);
  layOut();
  window.naoKin = Object.freeze({ viewer, state, tip, player, goals }); // for whoever reads or drives it from outside
  requestAnimationFrame(() => requestAnimationFrame(() => { page.dataset.state = stage ? "ready" : "failed"; }));
}

start().catch((error) => {
  unhappy("The page cannot be shown: it needs a browser of 2023 or later.");
  page.dataset.state = "failed";
  console.error(error);
});
