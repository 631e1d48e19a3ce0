// Things drawn beside the robot: rods between nodes, frames, joint axes, paths, targets and what is missing to them.

const AXIS_COLOURS = [0xd63b3b, 0x2f9e44, 0x2f6fd6];
const JOINT_AXIS_COLOUR = 0xd9940f, POINTER_COLOUR = 0x7a4fd0, TARGET_COLOUR = 0x0d8f6f, RESIDUAL_COLOUR = 0xd61f2c;

// The transform that puts the unit rod between two points.
function rodPose(start, end, radius) {
  const along = minus(end, start), x = across(along), y = cross(scaled(along, 1 / length(along)), x);
  return [...scaled(x, radius), 0, ...scaled(y, radius), 0, ...along, 0, ...start, 1];
}

class Marks {
  constructor(stage, size) {
    this.stage = stage;
    this.size = size; // [m] of the robot: what marks are in proportion to
    this.thin = 0.0022 * size;
    const kit = (name) => stage.viewer.scene_tree.find(["kit", name, "<object>"]).object;
    this.kit = { rod: kit("rod"), ball: kit("ball") };
  }

  solid(kind, colour, opacity = 1) {
    const mesh = this.kit[kind].clone();
    mesh.name = "mark";
    mesh.material = mesh.material.clone();
    mesh.material.color.set(colour);
    mesh.material.opacity = opacity;
    mesh.material.transparent = opacity < 1;
    mesh.castShadow = mesh.receiveShadow = false;
    this.stage.marks.add(mesh);
    return mesh;
  }

  stretch(rod, start, end, radius) {
    rod.visible = length(minus(end, start)) > 1e-7;
    if (rod.visible) setPose(rod, rodPose(start, end, radius));
  }

  putBall(ball, point, radius) {
    setPose(ball, [radius, 0, 0, 0, 0, radius, 0, 0, 0, 0, radius, 0, ...point, 1]);
  }

  // A frame: x red, y green, z blue. Returns a function that puts it at a pose, or hides it.
  frame(size = 0.09 * this.size, radius = this.thin) {
    const rods = AXIS_COLOURS.map((colour) => this.solid("rod", colour));
    return (pose) => rods.forEach((rod, k) => {
      rod.visible = Boolean(pose);
      if (!pose) return;
      const axis = pose.slice(4 * k, 4 * k + 3);
      this.stretch(rod, origin(pose), plus(origin(pose), scaled(axis, size)), radius);
    });
  }

  // An arrow from one point to another.
  arrow(colour) {
    const shaft = this.solid("rod", colour), head = this.solid("ball", colour);
    return (start, end) => {
      head.visible = Boolean(start) && length(minus(end, start)) > 1e-7;
      shaft.visible = head.visible;
      if (!head.visible) return;
      this.stretch(shaft, start, end, this.thin);
      this.putBall(head, end, 2.4 * this.thin);
    };
  }

  // The path of a point.
  path(points, colour) {
    points.slice(1).forEach((point, index) => {
      this.stretch(this.solid("rod", colour, 0.55), points[index], point, 0.8 * this.thin);
    });
  }

  // Rods like the scene's own, for a ghost.
  ghostRods(group, rods, world, colour) {
    for (const { start, end, radius, measured } of rods) {
      if (measured) continue;
      const rod = this.solid("rod", colour, 1.6 * GHOST_OPACITY);
      rod.material.depthWrite = false;
      this.stretch(rod, origin(world[start]), origin(world[end]), radius);
      group.add(rod);
    }
  }
}

// Sets of marks that a switch shows and hides; made when first shown, for a robot may have many.
class NodeMarks {
  constructor(make) {
    this.make = make;
    this.shown = false;
  }

  show(shown, state) {
    this.shown = shown;
    if (shown && !this.update) this.update = this.make();
    if (this.update) this.update(shown ? state : null);
  }

  follow(state) {
    if (this.shown) this.update(state);
  }
}

function frameMarks(marks, nodes) {
  return new NodeMarks(() => {
    const frames = nodes.map((index) => ({ index, put: marks.frame() }));
    return (state) => frames.forEach(({ index, put }) => put(state && state.world[index]));
  });
}

function jointAxisMarks(marks, scene) {
  return new NodeMarks(() => {
    const reach = 0.07 * marks.size;
    const axes = scene.nodes.flatMap((node, index) => (node.drive && node.label
      ? [{ index, axis: node.drive.axis, rod: marks.solid("rod", JOINT_AXIS_COLOUR) }] : []));
    return (state) => axes.forEach(({ index, axis, rod }) => {
      rod.visible = Boolean(state);
      if (!state) return;
      const pose = state.world[index], along = scaled(turned(pose, axis), reach);
      marks.stretch(rod, minus(origin(pose), along), plus(origin(pose), along), 1.3 * marks.thin);
    });
  });
}
