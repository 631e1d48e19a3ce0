// Feeds the recorded commands to the viewer and keeps the robot in the part of the window that nothing covers.
(() => {
  "use strict";

  const FIELD_OF_VIEW = 32; // degrees, vertical: little distortion, still depth
  const FILL = 0.9; // share of the free part of the window the robot may take
  const AZIMUTH = -35, ELEVATION = 20; // degrees; where the camera stands: ahead, to the robot's right, a little above

  const FOOTER = 36; // CSS pixels at the lower edge that the robot leaves to the footer

  const root = document.documentElement;
  const stage = document.getElementById("stage");
  const pane = document.getElementById("pane");
  const card = document.getElementById("card");

  function bytes(base64) {
    const binary = atob(base64);
    const result = new Uint8Array(binary.length);
    for (let i = 0; i < binary.length; i++) result[i] = binary.charCodeAt(i);
    return result;
  }

  async function inflated(deflated) {
    const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // The commands of the scene, one after the other as meshcat packs them.
  async function* commands() {
    const { lengths, deflated } = JSON.parse(document.getElementById("scene").textContent);
    const all = await inflated(bytes(deflated));
    let start = 0;
    for (const length of lengths) {
      yield all.slice(start, start + length);
      start += length;
    }
  }

  function unhappy(message) {
    const place = document.getElementById("trouble");
    place.textContent = message;
    place.hidden = false;
    root.dataset.state = "failed";
  }

  // Positions of all vertices of the robot, in the viewer's world: x forward, y up, z to the robot's right.
  function robotPoints(viewer) {
    const points = [];
    const robot = viewer.scene_tree.find(["robot"]).object;
    robot.updateWorldMatrix(true, true);
    robot.traverse((object) => {
      const e = object.matrixWorld.elements;
      if (!object.isMesh) return;
      const array = object.geometry.attributes.position.array;
      for (let i = 0; i < array.length; i += 3) {
        const [x, y, z] = [array[i], array[i + 1], array[i + 2]];
        points.push(
          e[0] * x + e[4] * y + e[8] * z + e[12],
          e[1] * x + e[5] * y + e[9] * z + e[13],
          e[2] * x + e[6] * y + e[10] * z + e[14]);
      }
    });
    if (!points.length) { // no triangles: the origins of the bodies
      robot.traverse((object) => points.push(...object.matrixWorld.elements.slice(12, 15)));
    }
    return points;
  }

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

  // Unit vectors of the camera: to the right, upwards and into the picture.
  function cameraAxes() {
    const a = AZIMUTH * Math.PI / 180, e = ELEVATION * Math.PI / 180;
    return {
      right: [Math.sin(-a), 0, -Math.cos(a)].map((v) => v || 0),
      up: [-Math.sin(e) * Math.cos(a), Math.cos(e), Math.sin(e) * Math.sin(a)],
      ahead: [-Math.cos(e) * Math.cos(a), -Math.sin(e), Math.cos(e) * Math.sin(a)],
    };
  }

  // Where the camera must stand so that every point lies within the given half-widths of the picture at distance 1.
  // Each side of the frustum is a plane that touches the cloud; opposite planes meet in a line, and the camera stands
  // on the farther of the two lines, in the middle of what the other pair leaves free.
  function placement(points, axes, halfWidth, halfHeight) {
    let [left, right, top, bottom, near, far] = [Infinity, -Infinity, -Infinity, Infinity, Infinity, -Infinity];
    for (let i = 0; i < points.length; i += 3) {
      const p = [points[i], points[i + 1], points[i + 2]];
      const r = dot(p, axes.right), u = dot(p, axes.up), f = dot(p, axes.ahead);
      right = Math.max(right, r - halfWidth * f); left = Math.min(left, r + halfWidth * f);
      top = Math.max(top, u - halfHeight * f); bottom = Math.min(bottom, u + halfHeight * f);
      near = Math.min(near, f); far = Math.max(far, f);
    }
    const touching = Math.min((left - right) / (2 * halfWidth), (bottom - top) / (2 * halfHeight));
    const depth = Math.min(touching, near - 0.05 * (far - near) - 1e-3);
    return { eye: [(left + right) / 2, (bottom + top) / 2, depth], distance: (near + far) / 2 - depth };
  }

  // Edges of the robot's image in CSS pixels of the stage, seen from `eye` with the picture centred on `part`.
  function imageOf(points, axes, eye, part) {
    const focal = part.height / 2 / Math.tan(FIELD_OF_VIEW * Math.PI / 360);
    const edges = { left: Infinity, right: -Infinity, top: Infinity, bottom: -Infinity };
    for (let i = 0; i < points.length; i += 3) {
      const p = [points[i], points[i + 1], points[i + 2]];
      const scale = focal / (dot(p, axes.ahead) - eye[2]);
      const x = part.x + part.width / 2 + scale * (dot(p, axes.right) - eye[0]);
      const y = part.y + part.height / 2 - scale * (dot(p, axes.up) - eye[1]);
      edges.left = Math.min(edges.left, x); edges.right = Math.max(edges.right, x);
      edges.top = Math.min(edges.top, y); edges.bottom = Math.max(edges.bottom, y);
    }
    return edges;
  }

  // The view that shows the robot largest without the card on it: on the whole stage if it misses the card there, else
  // on the part beside the card (wide windows) or below it (narrow ones).
  function bestView(points, axes) {
    const half = FILL * Math.tan(FIELD_OF_VIEW * Math.PI / 360);
    const box = card.getBoundingClientRect();
    const width = stage.clientWidth, height = Math.max(stage.clientHeight - FOOTER, 1);
    const view = (part) => ({ part, ...placement(points, axes, half * part.width / part.height, half) });
    const whole = view({ x: 0, y: 0, width, height });
    const image = imageOf(points, axes, whole.eye, whole.part);
    if (image.left > box.right || image.top > box.bottom) return whole;
    const parts = [
      { x: box.right, y: 0, width: width - box.right, height },
      { x: 0, y: box.bottom, width, height: height - box.bottom },
    ];
    const views = parts.filter((part) => part.width > 60 && part.height > 60).map(view);
    if (!views.length) return whole;
    const size = (candidate) => candidate.part.height / candidate.distance;
    return views.reduce((best, candidate) => (size(candidate) > size(best) ? candidate : best));
  }

  async function start() {
    const viewer = new MeshCat.Viewer(pane);
    viewer.gui.domElement.remove();
    for await (const command of commands()) viewer.handle_command_bytearray(command);
    const camera = viewer.camera, controls = viewer.controls;
    const points = robotPoints(viewer), axes = cameraAxes();
    let moved = false;
    let part = null; // of the stage, on which the picture is centred; it extends beyond it, under the card, to the edges
    let stageSize = "";
    controls.addEventListener("start", () => { moved = true; });

    function layOut() {
      const width = stage.clientWidth, height = stage.clientHeight;
      if (!width || !height) return;
      if (!moved) {
        const view = bestView(points, axes);
        part = view.part;
        stand(view);
      } else if (stageSize !== `${width} ${height}`) {
        part = { x: 0, y: 0, width, height };
      }
      stageSize = `${width} ${height}`;
      camera.fov = FIELD_OF_VIEW;
      camera.aspect = part.width / part.height;
      camera.setViewOffset(part.width, part.height, -part.x, -part.y, width, height);
      viewer.renderer.setSize(width, height);
      viewer.set_dirty();
    }

    function stand({ eye, distance }) {
      const world = (r, u, f) => [0, 1, 2].map((k) => r * axes.right[k] + u * axes.up[k] + f * axes.ahead[k]);
      camera.position.set(...world(...eye));
      camera.near = distance / 100;
      camera.far = distance * 20;
      controls.target.set(...world(eye[0], eye[1], eye[2] + distance));
      controls.minDistance = distance / 20;
      controls.maxDistance = distance * 8;
      controls.update();
    }

    function reset() {
      moved = false;
      layOut();
    }

    viewer.set_3d_pane_size = layOut; // the viewer calls it on load and on every resize, with the whole window in mind
    new ResizeObserver(layOut).observe(stage);
    for (const panel of card.querySelectorAll("details")) panel.addEventListener("toggle", layOut);
    document.getElementById("reset").addEventListener("click", reset);
    layOut();
    window.naoKin = Object.freeze({ viewer }); // for whoever reads or drives the picture from outside
    requestAnimationFrame(() => requestAnimationFrame(() => { root.dataset.state = "ready"; }));
  }

  start().catch((error) => {
    unhappy("The picture cannot be drawn: it needs WebGL and a browser of 2023 or later. The numbers are complete.");
    console.error(error);
  });
})();
