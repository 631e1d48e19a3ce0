// Words over the picture: elements of the page, moved to where their points are seen.

class Labels {
  constructor(layer, viewer) {
    this.layer = layer;
    this.viewer = viewer;
    this.entries = [];
    const render = viewer.render.bind(viewer);
    viewer.render = () => { // with every picture, and only then
      render();
      this.place();
    };
  }

  // A label whose text and point (in the robot's axes) are asked for with every picture; null hides it.
  add(kind, ask) {
    const element = el("span", { class: `label ${kind}`, hidden: true });
    this.layer.append(element);
    const entry = { element, ask };
    this.entries.push(entry);
    return entry;
  }

  // Point in CSS pixels of the stage, or null where it is behind the camera.
  seen(point) {
    const { camera, scene } = this.viewer, canvas = this.viewer.renderer.domElement;
    const apply = (m, [x, y, z, w]) => [0, 1, 2, 3].map((k) => m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k] * w);
    const steps = [scene.matrixWorld, camera.matrixWorldInverse, camera.projectionMatrix];
    const [x, y, , w] = steps.reduce((p, matrix) => apply(matrix.elements, p), [...point, 1]);
    if (w <= 0) return null;
    return [(0.5 + 0.5 * x / w) * canvas.clientWidth, (0.5 - 0.5 * y / w) * canvas.clientHeight];
  }

  // Of labels that would cover one another the earlier one is shown.
  place() {
    const taken = [];
    for (const { element, ask } of this.entries) {
      const asked = ask();
      const at = asked && this.seen(asked.point);
      element.hidden = !at;
      if (!at) continue;
      if (element.textContent !== asked.text) element.textContent = asked.text;
      const width = 7 + 6.4 * asked.text.length, height = 18; // close enough, and the page is not laid out for it
      const box = [at[0] + 6, at[1] - 9, at[0] + 6 + width, at[1] - 9 + height];
      const covered = taken.some((t) => box[0] < t[2] && t[0] < box[2] && box[1] < t[3] && t[1] < box[3]);
      element.hidden = covered;
      if (covered) continue;
      taken.push(box);
      element.style.transform = `translate(${(at[0] + 6).toFixed(1)}px, ${(at[1] - 9).toFixed(1)}px)`;
    }
  }
}
