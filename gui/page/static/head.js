// The head in three dimensions: draws the robots from their poses, the target, and its limits; a drag moves the target.
import { aim, grab, releaseHead, targetNow } from "./aim.js";
import { dragged, furthest, leans, onHead, orientations, picked, rotationOf, screenOf } from "./body.js";
import { flat, webgl } from "./paint.js";
import { byId, set } from "./parts.js";
import { text, view } from "./view.js";

const SIDES = ["sim", "hw"]; // by the number in a message of a pose
const DEG = 180 / Math.PI;
const GHOST = { share: 0.75, alpha: 0.3 };
const GREY = { tint: [110, 120, 130], share: 0.7, alpha: 1 }; // of a robot that is silent
const NEAR_DEG = 0.35; // difference of two heads that are drawn as one
const GLOW = 0.85; // share of a limit from which its border glows
const AHEAD = 0.06; // length (m) of the line from the nose
const EAR_PX = { mouse: 24, pen: 30, touch: 36 };
const SLOW_MS = 24; // time from the request of a picture to its end after which the next ones wait, at most REST_MS
const REST_MS = 250;
const ORBIT_DEG = 0.5; // turn of the camera for a pixel

const canvas = byId("bodies"), marks = byId("marks");
const colours = getComputedStyle(document.documentElement);
const colour = (name) => colours.getPropertyValue(`--${name}`).trim();
const parts = (name) => [1, 3, 5].map((at) => parseInt(colour(name).slice(at, at + 2), 16));
const poses = {}; // by side: arms (rad), head (deg), and the message
const others = {}; // the same of the robot that is drawn small, beside the own one
const small = document.querySelector("#beside canvas");
const camera = { azimuth: 0, elevation: 12 };
let drawn; // is called when the robots have just been drawn
let drawnSmall = ""; // what is drawn small
let model = null, paint = null, paintSmall = null, drag = null, orbit = null, over = null, frame = 0, rest = 0;

export async function connectHead(whenDrawn) {
  drawn = whenDrawn;
  model = await (await fetch("/head.json")).json();
  const chip = hasGraphicsChip();
  const renew = () => { paint = chip ? webgl(canvas, model) : flat(canvas, model); changed(); };
  paintSmall = flat(small, model);
  renew();
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault()); // a tablet that slept
  canvas.addEventListener("webglcontextrestored", renew);
  new ResizeObserver(changed).observe(marks);
  Object.assign(marks, { onpointerdown: press, onpointermove: move, onpointerup: release, onpointercancel: release });
  marks.onpointerleave = () => { if (!drag) hover(null); };
  marks.addEventListener("touchstart", (event) => { // a finger beside the head scrolls the page
    const { clientX, clientY } = event.touches[0];
    if (part({ clientX, clientY, pointerType: "touch" })) event.preventDefault();
  }, { passive: false });
  byId("around").onclick = () => {
    Object.assign(camera, { azimuth: seenFromFront() ? 180 : 0, elevation: 12 });
    showAround();
    changed();
  };
}

// WebGL that a processor computes is slower than `flat`, and delays heartbeats.
function hasGraphicsChip() {
  const gl = document.createElement("canvas").getContext("webgl"), info = gl?.getExtension("WEBGL_debug_renderer_info");
  return gl && !/swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(info?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER));
}

export const seenFromFront = () => Math.cos(camera.azimuth / DEG) > 0;

export function showAround() {
  set(byId("around"), text(seenFromFront() ? "page.from_behind" : "page.from_front"));
}

export function receivePose(data) {
  const [number] = new Uint8Array(data, 0, 1), side = SIDES[number % 2], known = number < 2 ? poses : others;
  const message = new Float32Array(data.slice(1)).join();
  if (known[side]?.message === message) return;
  const [short, middle, long, yaw, pitch, roll] = new Float32Array(data.slice(1));
  known[side] = { message, arms: [short, middle, long], head: { yaw: yaw * DEG, pitch: pitch * DEG, roll: roll * DEG } };
  changed();
}

// Draws at the next chance, on a slow computer less often: heartbeats must not wait. Nothing is drawn without a change.
export function changed() {
  frame ||= setTimeout(() => {
    const asked = performance.now();
    requestAnimationFrame(() => {
      draw();
      const busy = performance.now() - asked;
      rest = busy > SLOW_MS ? Math.min(2 * busy, REST_MS) : 0;
    });
  }, rest);
}

const paper = document.createElement("canvas");
let artist = null; // draws portraits, one after the other

// Draws a head alone, from the front.
export function portrait(sheet, head) {
  if (!model) return setTimeout(() => portrait(sheet, head), REST_MS);
  const side = 2 * sheet.clientWidth || 128, screen = screenOf({ azimuth: 0, elevation: 8 }, side, side);
  artist ??= flat(paper, model);
  for (const one of [sheet, paper]) Object.assign(one, { width: side, height: side });
  artist([{ turns: { head: rotationOf(head) }, tint: [0, 0, 0], share: 0, alpha: 1 }], { ...screen, lookedAt: model.skull[2], scale: side / 0.24 });
  sheet.getContext("2d").drawImage(paper, 0, 0);
}

const apart = (one, other) => ["yaw", "pitch", "roll"].some((name) => Math.abs(one[name] - other[name]) > NEAR_DEG);
const poseOf = (side) => view.head[side] && poses[side];
const turnsOf = ({ arms, head }) => orientations(model.rods, arms, rotationOf(head));
const strainOf = (target) => Math.hypot(target.pitch, target.roll) / furthest(view.border, target);

function figures({ solid, shown, silent }, aims) {
  const target = targetNow(), other = SIDES.find((side) => side !== solid), found = [];
  const own = shown && poses[solid], beside = poseOf(other);
  if (own) found.push({ turns: turnsOf(own), ...(silent ? GREY : { tint: [0, 0, 0], share: 0, alpha: 1 }) });
  if (beside && !(own && !apart(beside.head, own.head))) {
    const { base, ...moving } = turnsOf(beside);
    found.push({ turns: moving, tint: parts(other), ...GHOST });
  }
  if (aims && !(beside && !apart(beside.head, target))) {
    found.push({ turns: { head: rotationOf(target) }, tint: parts(strainOf(target) > 1 ? "bad" : "text"), ...GHOST });
  }
  return found;
}

// Draws the robot beside the own one: the hardware solid, and its twin as a ghost where it is elsewhere.
function drawSmall() {
  const { hw, sim } = others, { clientWidth: width, clientHeight: height } = small;
  const wanted = [view.you.beside, width, hw?.message, sim?.message].join(" ");
  if (!view.you.beside || !width || !(hw ?? sim) || wanted === drawnSmall) return;
  drawnSmall = wanted;
  Object.assign(small, { width: width * devicePixelRatio, height: height * devicePixelRatio });
  const found = [{ turns: turnsOf(hw ?? sim), tint: [0, 0, 0], share: 0, alpha: 1 }];
  if (hw && sim && apart(hw.head, sim.head)) found.push({ turns: turnsOf(sim), tint: parts("sim"), ...GHOST });
  paintSmall(found, screenOf({ azimuth: 0, elevation: 12 }, width, height));
}

function draw() {
  frame = 0;
  const { clientWidth: width, clientHeight: height } = marks, { head } = view;
  if (!paint || !head || !width) return;
  const ratio = Math.min(devicePixelRatio, 2), screen = screenOf(camera, width, height);
  for (const sheet of [canvas, marks]) {
    if (sheet.width !== Math.round(width * ratio)) sheet.width = Math.round(width * ratio);
    if (sheet.height !== Math.round(height * ratio)) sheet.height = Math.round(height * ratio);
  }
  const aims = Boolean(head.shown) && (drag !== null || apart(head.shown, targetNow()));
  paint(figures(head, aims), screen);
  drawn();
  drawSmall();
  const pen = marks.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  if (head.shown) drawMarks(pen, screen, head, aims);
}

// -- target, handles and limits -----------------------------------------------------------------------

function line(pen, points, name, width, { closed = false, dash = [] } = {}) {
  pen.setLineDash(dash);
  pen.lineWidth = width;
  pen.strokeStyle = colour(name);
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(x, y);
  if (closed) pen.closePath();
  pen.stroke();
}

function ring(pen, [x, y], radius, name, width) {
  const turns = Array.from({ length: 33 }, (_, index) => index * Math.PI / 16);
  line(pen, turns.map((turn) => [x + radius * Math.cos(turn), y + radius * Math.sin(turn)]), name, width);
}

function drawMarks(pen, screen, { drag: { refused, reason }, yaw_max: yawMax }, aims) {
  const target = targetNow(), strain = strainOf(target), { border } = view, held = drag?.part ?? over;
  const at = (point) => onHead(screen, target, point);
  if (aims || strain > GLOW) {
    const crowns = leans(border, target).map((lean) => onHead(screen, lean, model.crown));
    line(pen, crowns, "edge", 1.5, { closed: true, dash: [5, 4] });
    const near = Math.round(Math.atan2(target.pitch, target.roll) / (2 * Math.PI) * border.length) + border.length;
    const glowing = Array.from({ length: 13 }, (_, index) => crowns[(near + index - 6) % crowns.length]);
    if (strain > GLOW) line(pen, glowing, strain > 1 ? "bad" : "warn", 6);
    if (Math.abs(target.yaw) > GLOW * yawMax) ring(pen, at(model.nose), 12, "warn", 6);
  }
  if (held === "left" || held === "right") ring(pen, at(model.ears[held]), 18, "accent", 3);
  if (aims || held === "face") {
    const tip = at([model.nose[0] + AHEAD, model.nose[1], model.nose[2]]);
    line(pen, [at(model.nose), tip], held === "face" ? "accent" : "text", held === "face" ? 3 : 2);
    ring(pen, tip, 7, held === "face" ? "accent" : "text", 3);
  }
  if (refused) {
    const [x, y] = onHead(screen, refused, model.crown), label = `✕ ${reason}`;
    Object.assign(pen, { fillStyle: colour("bad"), strokeStyle: colour("field"), lineWidth: 5, lineJoin: "round", font: "600 15px system-ui, sans-serif" });
    const { width } = pen.measureText(label), left = Math.max(6, Math.min(screen.width - width - 6, x - width / 2));
    pen.strokeText(label, left, y);
    pen.fillText(label, left, y);
  }
}

// -- mouse and finger ---------------------------------------------------------------------------------

const screenNow = () => screenOf(camera, marks.clientWidth, marks.clientHeight);

function pointOf({ clientX, clientY }) {
  const { left, top } = marks.getBoundingClientRect();
  return [clientX - left, clientY - top];
}

// The part of the target, or of a robot if that is elsewhere, at an event; null: the ground.
function part(event) {
  if (!model || !view.head?.shown) return null;
  const heads = [targetNow(), ...SIDES.map((side) => poseOf(side)?.head)].filter(Boolean);
  const found = heads.map((head) => picked(model, screenNow(), head, ...pointOf(event), EAR_PX[event.pointerType] ?? 24));
  return found.find(Boolean) ?? null;
}

function press(event) {
  if (event.button || !event.isPrimary) return;
  const [x, y] = pointOf(event), grabbed = part(event);
  marks.setPointerCapture(event.pointerId);
  if (grabbed) {
    drag = { screen: screenNow(), start: targetNow(), part: grabbed, x, y };
    grab();
  } else orbit = { x, y, ...camera };
  changed();
}

function move(event) {
  const [x, y] = pointOf(event);
  if (drag) {
    aim(dragged(drag, x, y, view.head.tilt_max, view.head.yaw_max));
  } else if (orbit) {
    camera.azimuth = orbit.azimuth - (x - orbit.x) * ORBIT_DEG;
    showAround();
    camera.elevation = Math.max(-10, Math.min(80, orbit.elevation + (y - orbit.y) * ORBIT_DEG));
  } else {
    hover(part(event));
    return;
  }
  changed();
}

function hover(now) {
  if (now === over) return;
  over = now;
  marks.classList.toggle("over", Boolean(over));
  changed();
}

function release() {
  if (drag) releaseHead();
  drag = orbit = null;
  hover(null);
  changed();
}
