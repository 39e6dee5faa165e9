// Photo and film of the head, which the browser makes from what it draws, and the button that shows them to the class.
import { changed } from "./head.js";
import { byId } from "./parts.js";
import { text, token, view } from "./view.js";

const FILM_MS = 10000, LONGEST_MS = 60000; // a film ends after ten seconds, later while the robot moves, or after a minute
const FRAME_MS = 40;
const BITS = 600000; // in a second
const BYTES_MAX = 5e6; // as in gallery.py
const KINDS = ["video/mp4;codecs=avc1.42E01E", "video/webm", "video/mp4"]; // phones send MP4 to each other
const SIZES = { photo: [960, 780], film: [640, 520] }; // px; the last thirteenth is for name and date

const bodies = byId("bodies");
const kind = KINDS.find((one) => window.MediaRecorder?.isTypeSupported(one));
const colours = getComputedStyle(document.documentElement);
let film = null; // { recorder, pen, began, timer }
let photo = null; // the pen of a photo that is taken of the next picture
let shot = null; // { file, name }

const name = () => view.you.name || view.you.seat || view.robot;
const today = () => new Date().toLocaleDateString("sv"); // 2026-11-30

function penOf([width, height]) {
  return Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
}

// Copies the robots as they have just been drawn, with the caption below.
function copy(pen) {
  const { width, height } = pen.canvas, room = height * 12 / 13, edge = (height - room) / 2;
  const wide = bodies.width * room / bodies.height;
  const fill = (role, ...place) => { pen.fillStyle = colours.getPropertyValue(`--${role}`); pen.fillRect(...place); };
  fill("raised", 0, 0, width, height);
  pen.drawImage(bodies, (width - wide) / 2, 0, wide, room);
  fill("panel", 0, room, width, height - room);
  Object.assign(pen, { fillStyle: colours.getPropertyValue("--text"), font: `${edge}px system-ui, sans-serif`, textBaseline: "middle" });
  for (const [align, x, words] of [["left", edge, name()], ["right", width - edge, today()]]) {
    pen.textAlign = align;
    pen.fillText(words, x, room + edge, width * 0.6);
  }
}

// Is called when the robots have just been drawn: with WebGL their picture is lost soon afterwards.
export function drawn() {
  if (film) {
    copy(film.pen);
    if (film.recorder.state === "inactive") film.recorder.start(); // not before there is a picture
  }
  if (!photo) return;
  const { canvas } = photo;
  copy(photo);
  photo = null;
  canvas.toBlob((file) => present(file, "png"));
}

function beginFilm() {
  const pen = penOf(SIZES.film), parts = [];
  const recorder = new MediaRecorder(pen.canvas.captureStream(1000 / FRAME_MS), { mimeType: kind, videoBitsPerSecond: BITS });
  recorder.ondataavailable = ({ data }) => parts.push(data);
  recorder.onstop = () => present(new Blob(parts, { type: kind.split(";")[0] }), kind.slice(6).split(";")[0]);
  film = { recorder, pen, began: performance.now(), timer: setInterval(tick, FRAME_MS) };
  tick();
}

function tick() {
  const lasts = performance.now() - film.began;
  if (document.hidden || lasts > LONGEST_MS || (lasts > FILM_MS && !view.you.moves)) return endFilm();
  byId("film").textContent = `■ 0:${String(Math.floor(lasts / 1000)).padStart(2, "0")}`;
  changed();
}

function endFilm() {
  clearInterval(film.timer);
  if (film.recorder.state !== "inactive") film.recorder.stop();
  film = null;
  byId("film").textContent = text("picture.film");
}

// Shows a photo or film in place of the head, until it is closed.
function present(file, ending) {
  close();
  shot = { file, name: `${name()}-${today()}.${ending}` };
  const source = URL.createObjectURL(file), shown = document.createElement(ending === "png" ? "img" : "video");
  Object.assign(shown, { src: source, alt: shot.name, loop: true, muted: true, autoplay: true, playsInline: true });
  byId("shot-picture").replaceChildren(shown);
  Object.assign(byId("shot-save"), { href: source, download: shot.name });
  byId("shot-show").hidden = !view.you.name; // only a class has a gallery
  byId("shot-note").textContent = "";
  byId("shot").hidden = false;
}

function close() {
  if (shot) URL.revokeObjectURL(byId("shot-save").href);
  shot = null;
  byId("shot").hidden = true;
}

async function showClass() {
  byId("shot-show").disabled = true;
  const shown = shot;
  const request = { method: "POST", headers: { "X-XSRFToken": token }, body: shot.file };
  const reply = shot.file.size <= BYTES_MAX && await fetch("/gallery", request).catch(() => null);
  const key = reply ? await reply.text() : reply === false ? "page.show_large" : "";
  byId("shot-show").disabled = false;
  if (shot !== shown) return; // another picture is open now
  byId("shot-note").textContent = text(key) || text("page.show_failed");
  byId("shot-show").hidden = key === "page.shown";
}

export function connectShow() {
  byId("photo").onclick = () => { photo = penOf(SIZES.photo); changed(); };
  byId("film").hidden = !kind;
  byId("film").onclick = () => (film ? endFilm() : beginFilm());
  byId("shot-show").onclick = showClass;
  byId("shot-close").onclick = close;
}
