// Rigid transforms as arrays of 16 numbers, column by column, in double precision.

const identity = () => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
const origin = (m) => [m[12], m[13], m[14]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const scaled = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const length = (a) => Math.hypot(a[0], a[1], a[2]);

function product(a, b) {
  const m = new Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += a[4 * k + row] * b[4 * column + k];
      m[4 * column + row] = sum;
    }
  }
  return m;
}

function inverse(m) {
  const p = origin(m);
  return [
    m[0], m[4], m[8], 0, m[1], m[5], m[9], 0, m[2], m[6], m[10], 0,
    -dot([m[0], m[1], m[2]], p), -dot([m[4], m[5], m[6]], p), -dot([m[8], m[9], m[10]], p), 1,
  ];
}

const turned = (m, v) => [0, 1, 2].map((row) => m[row] * v[0] + m[4 + row] * v[1] + m[8 + row] * v[2]);
const acted = (m, p) => plus(turned(m, p), origin(m));

// A turn by an angle [rad] about a unit axis, or a slide [m] along it.
function motion([x, y, z], value, slides) {
  if (slides) return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, value * x, value * y, value * z, 1];
  const s = Math.sin(value), half = Math.sin(value / 2), v = 2 * half * half;
  return [
    1 - v * (y * y + z * z), v * x * y + s * z, v * x * z - s * y, 0,
    v * x * y - s * z, 1 - v * (x * x + z * z), v * y * z + s * x, 0,
    v * x * z + s * y, v * y * z - s * x, 1 - v * (x * x + y * y), 0,
    0, 0, 0, 1,
  ];
}

// Rz(yaw) Ry(pitch) Rx(roll), as URDF has it.
function fromPositionAndAngles(position, [roll, pitch, yaw]) {
  const turn = product(product(motion([0, 0, 1], yaw), motion([0, 1, 0], pitch)), motion([1, 0, 0], roll));
  [turn[12], turn[13], turn[14]] = position;
  return turn;
}

function rollPitchYaw(m) {
  const level = Math.hypot(m[0], m[1]);
  if (level < 1e-12) return [0, Math.atan2(-m[2], level), Math.atan2(-m[4], m[5])]; // roll and yaw turn about one axis
  return [Math.atan2(m[6], m[10]), Math.atan2(-m[2], level), Math.atan2(m[1], m[0])];
}

// The rotation vector [rad] of a rotation: its axis times its angle.
function rotationVector(m) {
  const twice = [m[6] - m[9], m[8] - m[2], m[1] - m[4]];
  const sine = length(twice), cosine = m[0] + m[5] + m[10] - 1;
  const angle = Math.atan2(sine, cosine);
  if (sine > 1e-6) return scaled(twice, angle / sine);
  if (cosine > 0) return scaled(twice, 0.5);
  // Close to a half turn the axis stands in the symmetric part.
  const largest = [0, 1, 2].reduce((best, k) => (m[5 * k] > m[5 * best] ? k : best), 0);
  const axis = [0, 1, 2].map((row) => m[4 * largest + row] + m[4 * row + largest] + (row === largest ? 1 - cosine : 0));
  return scaled(axis, angle / length(axis));
}

// A unit vector at right angles to a given one.
function across(v) {
  const smallest = [0, 1, 2].reduce((best, k) => (Math.abs(v[k]) < Math.abs(v[best]) ? k : best), 0);
  const other = cross(v, [0, 1, 2].map((k) => (k === smallest ? 1 : 0)));
  return scaled(other, 1 / length(other));
}
