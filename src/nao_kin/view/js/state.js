// Joint values and where they bring the nodes: the page's forward kinematics.

const LIMIT_TOLERANCE = 1e-9; // [rad, m] a value is outside its range beyond this

function interpolated(x, at, y) {
  if (x <= at[0]) return y[0];
  for (let k = 1; k < at.length; k++) {
    if (x <= at[k]) return y[k - 1] + (y[k] - y[k - 1]) * (x - at[k - 1]) / (at[k] - at[k - 1]);
  }
  return y[y.length - 1];
}

// Sets a joint's motor and all joints that go with it; returns the motor.
function setJoint(joints, values, joint, value) {
  const { leader, multiplier, offset } = joints[joint];
  const motor = leader < 0 ? joint : leader;
  values[motor] = leader < 0 ? value : (value - offset) / multiplier;
  joints.forEach((other, k) => {
    if (other.leader === motor) values[k] = other.multiplier * values[motor] + other.offset;
  });
  values[joint] = value;
  return motor;
}

class State {
  constructor(scene) {
    this.scene = scene;
    this.joints = scene.joints;
    this.values = scene.joints.map((joint) => joint.value);
    this.first = [...this.values];
    this.body = identity(); // T_ground_root
    this.held = new Map(); // joint that was moved along into its range: the joint that did it
    this.listeners = [];
    this.place();
  }

  listen(listener) {
    this.listeners.push(listener);
  }

  // Poses of all nodes, in their parents and in the ground's frame, for joint values of one's choice.
  poses(values, body = this.body) {
    const local = [], world = [];
    for (const node of this.scene.nodes) {
      const drive = node.drive;
      let pose = node.placement;
      if (drive) {
        const value = drive.multiplier * values[drive.joint] + drive.offset;
        pose = product(pose, motion(drive.axis, value, drive.slides));
      }
      if (node.parent < 0) pose = product(body, pose);
      local.push(pose);
      world.push(node.parent < 0 ? pose : product(world[node.parent], pose));
    }
    return { local, world };
  }

  place() {
    Object.assign(this, this.poses(this.values));
  }

  changed(cause) {
    this.place();
    for (const listener of this.listeners) listener(this, cause);
  }

  // The range of a joint where the others stand: its own, cut down by coupled limits; null where there is no end.
  range(joint) {
    let { lower, upper } = this.joints[joint];
    for (const rule of this.scene.rules) {
      if (rule.joint !== joint) continue;
      const by = rule.even ? Math.abs(this.values[rule.by]) : this.values[rule.by];
      const [least, most] = [interpolated(by, rule.at, rule.lower), interpolated(by, rule.at, rule.upper)];
      lower = lower === null ? least : Math.max(lower, least);
      upper = upper === null ? most : Math.min(upper, most);
    }
    return [lower, upper];
  }

  isOutside(joint) {
    const [lower, upper] = this.range(joint), value = this.values[joint];
    return (lower !== null && value < lower - LIMIT_TOLERANCE) || (upper !== null && value > upper + LIMIT_TOLERANCE);
  }

  drive(joint, value) {
    return setJoint(this.joints, this.values, joint, value);
  }

  // What a person does with one joint: joints whose ranges depend on it stay within them.
  move(joint, value) {
    const dependent = this.scene.rules.filter((rule) => !this.isOutside(rule.joint)).map((rule) => rule.joint);
    this.held.delete(joint);
    const motor = this.drive(joint, value);
    for (const rule of this.scene.rules) {
      if (rule.by !== motor || !dependent.includes(rule.joint)) continue;
      const [lower, upper] = this.range(rule.joint), now = this.values[rule.joint];
      const inside = Math.min(Math.max(now, lower), upper);
      if (inside === now) continue;
      this.drive(rule.joint, inside);
      this.held.set(rule.joint, motor);
    }
    this.changed("joint");
  }

  // Joint values as given, whatever the limits: of all joints, or by pairs of joint and value.
  assume(values, cause = "posture") {
    this.held.clear();
    this.values = [...values];
    this.changed(cause);
  }

  assign(pairs, cause) {
    this.held.clear();
    for (const [joint, value] of pairs) this.drive(joint, value);
    this.changed(cause);
  }

  // T_base_tip
  between(base, tip) {
    return product(inverse(this.world[base]), this.world[tip]);
  }
}
