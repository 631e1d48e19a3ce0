// Where the camera stands: as near as the robot lets it, with the robot in the part of the window that nothing covers.

const FIELD_OF_VIEW = 32; // degrees, vertical: little distortion, still depth
const FILL = 0.9; // share of the free part of the window the robot may take
const AZIMUTH = -35, ELEVATION = 20; // degrees; where the camera stands: ahead, to the robot's right, a little above

// Unit vectors of the camera: to the right, upwards and into the picture, in the viewer's axes (y up, z to the right).
function cameraAxes() {
  const a = AZIMUTH * Math.PI / 180, e = ELEVATION * Math.PI / 180;
  return {
    right: [Math.sin(-a), 0, -Math.cos(a)].map((v) => v || 0),
    up: [-Math.sin(e) * Math.cos(a), Math.cos(e), Math.sin(e) * Math.sin(a)],
    ahead: [-Math.cos(e) * Math.cos(a), -Math.sin(e), Math.cos(e) * Math.sin(a)],
  };
}

// Positions of all visible vertices below some objects, in the viewer's axes; or of the objects where they have none.
function pointsOf(objects) {
  const points = [];
  const visit = (object) => {
    if (!object.visible) return;
    const e = object.matrixWorld.elements;
    const array = object.isMesh ? object.geometry.attributes.position.array : [];
    for (let i = 0; i < array.length; i += 3) {
      const [x, y, z] = [array[i], array[i + 1], array[i + 2]];
      points.push(
        e[0] * x + e[4] * y + e[8] * z + e[12],
        e[1] * x + e[5] * y + e[9] * z + e[13],
        e[2] * x + e[6] * y + e[10] * z + e[14]);
    }
    object.children.forEach(visit);
  };
  for (const object of objects) {
    object.updateWorldMatrix(true, true);
    visit(object);
  }
  if (!points.length) {
    for (const object of objects) object.traverse((each) => points.push(...each.matrixWorld.elements.slice(12, 15)));
  }
  return points;
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

class CameraMan {
  // `freePart` says which part of the stage, in CSS pixels, nothing covers.
  constructor(viewer, stage, freePart, subjects) {
    Object.assign(this, { viewer, stage, freePart, subjects });
    this.axes = cameraAxes();
    this.moved = false;
    this.size = "";
    viewer.controls.addEventListener("start", () => { this.moved = true; });
    viewer.set_3d_pane_size = () => this.layOut(); // the viewer calls it with the whole window in mind
    new ResizeObserver(() => this.layOut()).observe(stage);
  }

  frame() {
    this.moved = false;
    this.layOut();
  }

  layOut() {
    const width = this.stage.clientWidth, height = this.stage.clientHeight;
    if (!width || !height) return;
    const camera = this.viewer.camera;
    if (!this.moved) {
      this.part = this.freePart();
      this.stand();
    } else if (this.size !== `${width} ${height}`) {
      this.part = { x: 0, y: 0, width, height };
    }
    this.size = `${width} ${height}`;
    camera.fov = FIELD_OF_VIEW;
    camera.aspect = this.part.width / this.part.height;
    camera.setViewOffset(this.part.width, this.part.height, -this.part.x, -this.part.y, width, height);
    this.viewer.renderer.setSize(width, height);
    this.viewer.set_dirty();
  }

  stand() {
    const { axes, part } = this, { camera, controls } = this.viewer;
    const half = FILL * Math.tan(FIELD_OF_VIEW * Math.PI / 360);
    const view = placement(pointsOf(this.subjects()), axes, half * part.width / part.height, half);
    const world = (r, u, f) => plus(plus(scaled(axes.right, r), scaled(axes.up, u)), scaled(axes.ahead, f));
    const [r, u, f] = view.eye;
    camera.position.set(...world(r, u, f));
    camera.near = view.distance / 100;
    camera.far = view.distance * 20;
    controls.target.set(...world(r, u, f + view.distance));
    controls.minDistance = view.distance / 20;
    controls.maxDistance = view.distance * 8;
    controls.update();
  }
}
