// A leg of three joints in closed form: the joints that bring its foot to a point. The numbers of a leg and the
// equations are those of nao_kin.analytic.hexapod.hexapod_leg_kernel, which says where they come from.

const LEG = { turn: 0, origin: 9, coxa: 12, femur: 13, tibia: 14, lateral: 15, signs: 16, offsets: 19, middles: 22 };
const ROUNDING = 1e-12, SAME_BEND = 1e-14, MERGED = 1e-7; // relative

function wrapped(angle) {
  return angle - 2 * Math.PI * Math.floor((angle + Math.PI) / (2 * Math.PI));
}

// The foot in the coxa's frame.
function seenFromCoxa(leg, p) {
  return [0, 1, 2].map((k) => dot(leg.slice(3 * k, 3 * k + 3), p) + leg[LEG.origin + k]);
}

// The angles ±t between two links that span a distance: [how many, t, sine, cosine].
function bend(a, b, distance, slack) {
  const longest = a + b, shortest = Math.abs(a - b);
  if (!(shortest - slack <= distance && distance <= longest + slack)) return [0, 0, 0, 1];
  const toStraight = (longest - distance) * (longest + distance);
  const fromFolded = (distance - shortest) * (distance + shortest);
  if (toStraight <= SAME_BEND * longest * longest) return [1, 0, 0, 1];
  if (fromFolded <= SAME_BEND * longest * longest) return [1, Math.PI, 0, -1];
  const t = 2 * Math.atan2(Math.sqrt(toStraight), Math.sqrt(fromFolded));
  return [2, t, Math.sqrt(toStraight * fromFolded) / (2 * a * b), (fromFolded - toStraight) / (4 * a * b)];
}

// Every solution for a foot at a point of the body's frame, as three joint values each.
function legSolutions(leg, p, slackGiven = 0) {
  const [x, y, z] = seenFromCoxa(leg, p);
  const e = leg[LEG.lateral], scale = leg[LEG.coxa] + leg[LEG.femur] + leg[LEG.tibia];
  const slack = Math.max(slackGiven, ROUNDING * scale), out = Math.hypot(x, y);
  if (out < Math.abs(e) - slack) return [];
  const forward = Math.sqrt(Math.max((out - Math.abs(e)) * (out + Math.abs(e)), 0));
  if (forward <= ROUNDING * scale && e === 0) return inLegPlane(leg, leg[LEG.middles], forward, z, 0, slack);
  const ahead = Math.atan2(y * forward - x * e, x * forward + y * e);
  if (e !== 0 && forward <= MERGED * scale) return inLegPlane(leg, ahead, forward, z, 0, slack);
  const over = Math.atan2(-y * forward - x * e, -x * forward + y * e);
  return [...inLegPlane(leg, ahead, forward, z, 0, slack), ...inLegPlane(leg, over, -forward, z, 1, slack)];
}

function inLegPlane(leg, coxa, x, z, over, slack) {
  const a = leg[LEG.femur], b = leg[LEG.tibia], out = x - leg[LEG.coxa], distance = Math.hypot(out, z);
  const [bends, bent, sine, cosine] = bend(a, b, distance, slack);
  let towards = Math.atan2(out, z), ahead = Math.atan2(b * sine, a + b * cosine);
  if (distance <= ROUNDING * (a + b)) [towards, ahead] = [leg[LEG.middles + 1], 0];
  const found = [];
  for (let knee = 0; knee < bends; knee++) {
    const up = knee === over ? 1 : -1;
    const angles = [coxa, towards - up * ahead, up * bent];
    found.push(angles.map((angle, k) => wrapped(leg[LEG.signs + k] * (angle - leg[LEG.offsets + k]))));
  }
  return found;
}

// How far a point is from all that the leg reaches without limits [m]: above 0 too far, below too near.
function legMissesBy(leg, p) {
  const [x, y, z] = seenFromCoxa(leg, p);
  const coxa = leg[LEG.coxa], e = leg[LEG.lateral], out = Math.hypot(x, y);
  const radius = e === 0 ? coxa : Math.hypot(coxa, e);
  const near = Math.hypot(out - radius, z), far = Math.hypot(out + radius, z);
  const longest = leg[LEG.femur] + leg[LEG.tibia], shortest = Math.abs(leg[LEG.femur] - leg[LEG.tibia]);
  if (near > longest) return near - longest;
  if (far < shortest) return far - shortest;
  if (e !== 0 || near >= shortest || far <= longest) return 0;
  return far - longest < shortest - near ? far - longest : near - shortest; // too near pointing at it, too far beyond
}
