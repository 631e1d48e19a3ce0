// The picture: the viewer's objects, set to where the state has their nodes, and ghosts of the robot elsewhere.

const GHOST_OPACITY = 0.2;
const COLLISION_COLOUR = 0x299e85, COLLISION_OPACITY = 0.4; // as record.py has them

// The viewer's path of every node; its names are our own numbers.
function nodePaths(nodes) {
  const paths = [];
  nodes.forEach((node, index) => paths.push([...(node.parent < 0 ? ["robot"] : paths[node.parent]), `n${index}`]));
  return paths;
}

function setPose(object, pose) {
  object.matrixAutoUpdate = false;
  object.matrix.fromArray(pose);
  object.matrixWorldNeedsUpdate = true;
}

// A node's own triangles: the viewer hangs each surface below a group of its own, beside the nodes' children.
function surfacesOf(object) {
  const found = [];
  for (const child of object.children) {
    if (!/^m\d+$/.test(child.name)) continue;
    child.traverse((each) => { if (each.isMesh && each.name !== "collision") found.push(each); });
  }
  return found;
}

// A veil over a surface that is a collision shape as well.
function collisionCopy(surface) {
  const copy = surface.clone();
  copy.name = "collision";
  copy.material = surface.material.clone();
  copy.material.color.set(COLLISION_COLOUR);
  copy.material.opacity = COLLISION_OPACITY;
  copy.material.transparent = true;
  copy.material.polygonOffset = true; // in front of what it covers
  copy.material.polygonOffsetFactor = copy.material.polygonOffsetUnits = -2;
  surface.parent.add(copy);
  return copy;
}

class Stage {
  constructor(viewer, scene) {
    this.viewer = viewer;
    this.scene = scene;
    this.world = viewer.scene; // z up, as the robot
    this.robot = viewer.scene_tree.find(["robot"]).object;
    this.ground = viewer.scene_tree.find(["ground"]).object;
    this.objects = nodePaths(scene.nodes).map((path) => viewer.scene_tree.find(path).object);
    this.ghosts = [];
    this.marks = this.robot.clone(false); // an empty group of its own
    this.marks.name = "marks";
    this.world.add(this.marks);
    this.colours = new Map(); // of surfaces that were painted over: what they had
  }

  show(state) {
    this.objects.forEach((object, index) => setPose(object, state.local[index]));
    this.thinGhosts(state);
  }

  // Copies of the robot that share its triangles, one for each posture, tinted.
  setGhosts(state, marks, ghosts) {
    for (const { group } of this.ghosts) this.world.remove(group);
    this.ghosts = ghosts.map(({ values, colour }) => {
      const group = this.robot.clone(true);
      const byName = new Map();
      group.traverse((object) => {
        byName.set(object.name, object);
        if (!object.isMesh) return;
        object.castShadow = object.receiveShadow = false;
        object.material = object.material.clone();
        object.material.color.lerp(object.material.color.clone().set(colour), 0.55);
        object.material.opacity *= GHOST_OPACITY;
        object.material.transparent = true;
        object.material.depthWrite = false;
        object.material.polygonOffset = true; // behind what stands in the same place
        object.material.polygonOffsetFactor = object.material.polygonOffsetUnits = 2;
      });
      const { local, world } = state.poses(values);
      const objects = local.map((_, index) => byName.get(`n${index}`));
      local.forEach((pose, index) => setPose(objects[index], pose));
      this.world.add(group);
      marks.ghostRods(group, this.scene.rods, world, colour);
      return { group, world, objects };
    });
    this.thinGhosts(state);
  }

  // Parts of a ghost that stand where the robot or an earlier ghost has them are left out: they would only tint it.
  thinGhosts(state) {
    const seen = [state.world];
    for (const { world, objects } of this.ghosts) {
      objects.forEach((object, index) => {
        const same = (other) => world[index].every((entry, k) => Math.abs(entry - other[index][k]) < 1e-6);
        const covered = seen.some(same);
        for (const surface of surfacesOf(object)) surface.visible = !covered;
      });
      seen.push(world);
    }
    this.viewer.set_dirty();
  }

  setCollisions(shown) {
    this.collisions ??= this.objects.flatMap((object, index) =>
      (this.scene.nodes[index].collides ? surfacesOf(object).map(collisionCopy) : []));
    const apart = this.objects.flatMap((object) => object.children.filter(({ name }) => name === "c"));
    for (const object of [...apart, ...this.collisions]) object.visible = shown;
    this.viewer.set_dirty();
  }

  // Paints the surfaces of some nodes in one colour, or gives them their own back where the colour is null.
  paint(nodes, colour) {
    for (const index of nodes) {
      for (const surface of surfacesOf(this.objects[index])) {
        if (!this.colours.has(surface)) this.colours.set(surface, surface.material.color.getHex());
        surface.material.color.set(colour ?? this.colours.get(surface));
      }
    }
    this.viewer.set_dirty();
  }

  // The ground's lines are drawn for a light page.
  setDark(dark) {
    this.ground.traverse((object) => {
      if (object.isLineSegments) object.material.color.setScalar(dark ? 0.42 : 1);
    });
    this.viewer.set_dirty();
  }
}
