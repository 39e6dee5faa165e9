// The bodies of the robot: their rotations, where their points are on a picture, and drags of the head.
// The formulas are those of beatrix_zenoh/body and of the window; tests compare them. A matrix is nine numbers, row by row.
const LOOKED_AT = 0.066; // height (m, from the neck centre) of the middle of the picture
const HALF_HEIGHT = 0.172; // half of the height (m) that the picture shows
export const AWAY = 1.1; // distance of the camera (m)
const HEAD_RADIUS = 0.1; // way (m) of a drag for 1 rad of yaw or pitch
const EAR_LEVER = 0.08; // the same for roll
const FACING_DEG = 110; // up to this angle between nose and viewer a drag moves the near side of the head, else the far side
const BEYOND = 1.2; // largest lean of a target, divided by the limit: the refusal of it explains the limit
const RAD = Math.PI / 180;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const apply = (m, [x, y, z]) => [m[0] * x + m[1] * y + m[2] * z, m[3] * x + m[4] * y + m[5] * z, m[6] * x + m[7] * y + m[8] * z];
export const times = (a, b) => [0, 3, 6].flatMap((row) => [0, 1, 2].map(
  (column) => a[row] * b[column] + a[row + 1] * b[column + 3] + a[row + 2] * b[column + 6]));

export function rotationOf({ yaw, pitch, roll }) { // deg
  const [sy, cy, sp, cp, sr, cr] = [yaw, pitch, roll].flatMap((angle) => [Math.sin(angle * RAD), Math.cos(angle * RAD)]);
  return [
    cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,
    sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
    -sp, cp * sr, cp * cr,
  ];
}

function about([x, y, z], angle) { // a unit vector, rad
  const s = Math.sin(angle), c = Math.cos(angle), d = 1 - c;
  return [
    c + x * x * d, x * y * d - z * s, x * z * d + y * s,
    x * y * d + z * s, c + y * y * d, y * z * d - x * s,
    x * z * d - y * s, y * z * d + x * s, c + z * z * d,
  ];
}

// The angle of a rod about its elbow that brings its end to the skull's mount.
function rodAngle({ elbow, mount }, arm, head) {
  const seen = apply(about([0, 0, 1], -arm), apply(head, mount));
  return Math.atan2(dot(elbow, cross(mount, seen)), dot(mount, seen) - dot(elbow, mount) * dot(elbow, seen));
}

// Returns the matrix of each body, by its path; arms in rad.
export function orientations(rods, arms, head) {
  const turns = { base: about([0, 0, 1], 0), head };
  for (const [index, name] of ["short", "middle", "long"].entries()) {
    const arm = turns[`arm_${name}`] = about([0, 0, 1], arms[index]);
    turns[`arm_${name}/rod_${name}`] = times(arm, about(rods[index].elbow, rodAngle(rods[index], arms[index], head)));
  }
  return turns;
}

// Returns a camera with the size of its picture (px); azimuth 0 is in front of the robot, 90 at its left (deg).
export function screenOf({ azimuth, elevation }, width, height) {
  const [sa, ca, se, ce] = [azimuth, elevation].flatMap((angle) => [Math.sin(angle * RAD), Math.cos(angle * RAD)]);
  const axes = [-sa, ca, 0, -se * ca, -se * sa, ce, ce * ca, ce * sa, se]; // right, up, towards the viewer
  return { azimuth, axes, width, height, lookedAt: LOOKED_AT, scale: Math.min(height, width * 1.1) / (2 * HALF_HEIGHT) };
}

// Returns x, y (px) and nearness (m) of a point (m).
export function place(screen, [x, y, z]) {
  const [right, up, near] = apply(screen.axes, [x, y, z - screen.lookedAt]);
  const size = screen.scale * AWAY / Math.max(AWAY - near, 0.05);
  return [screen.width / 2 + right * size, screen.height / 2 - up * size, near];
}

export const onHead = (screen, head, point) => place(screen, apply(rotationOf(head), point));

// Returns `left` or `right` for an ear at a point of the picture, `face`, or null; `reach`: how near (px) an ear must be.
export function picked(model, screen, head, x, y, reach) {
  const middle = onHead(screen, head, model.skull), nose = onHead(screen, head, model.nose);
  const from = (point) => Math.hypot(x - point[0], y - point[1]);
  for (const part of ["left", "right"]) {
    const ear = onHead(screen, head, model.ears[part]);
    if (ear[2] > middle[2] - 0.06 && from(ear) < reach) return part; // not an ear that the head hides
  }
  return from(middle) < screen.scale * HEAD_RADIUS || from(nose) < reach ? "face" : null;
}

// Returns the target of a drag ({ screen, start, part, x, y }) at a point of the picture.
export function dragged({ screen, start, part, x, y }, toX, toY, leanMax, yawMax) {
  const degrees = 1 / (RAD * (part === "face" ? HEAD_RADIUS : EAR_LEVER) * screen.scale);
  const right = (toX - x) * degrees, up = (y - toY) * degrees;
  let { yaw, pitch, roll } = start;
  if (part === "face") {
    yaw += Math.cos((yaw - screen.azimuth) * RAD) > Math.cos(FACING_DEG * RAD) ? right : -right;
    pitch -= up;
  } else roll += part === "left" ? up : -up;
  const shrink = Math.min(1, leanMax * BEYOND / Math.max(Math.hypot(pitch, roll), 1e-9));
  const tenth = (angle) => Math.round(angle * 10) / 10 + 0;
  return { yaw: tenth(Math.max(-yawMax, Math.min(yawMax, yaw))), pitch: tenth(pitch * shrink), roll: tenth(roll * shrink) };
}

// Returns how far the head may lean in the direction of a pitch and roll.
export function furthest(border, { pitch, roll }) {
  const turn = (Math.atan2(pitch, roll) / (2 * Math.PI) + 1) * border.length;
  const first = Math.floor(turn), share = turn - first;
  return border[first % border.length] * (1 - share) + border[(first + 1) % border.length] * share;
}

// Returns the furthest leans of a target in all directions.
export const leans = (border, { yaw }) => border.map((lean, index) => {
  const turn = 2 * Math.PI * index / border.length;
  return { yaw, pitch: lean * Math.sin(turn), roll: lean * Math.cos(turn) };
});
