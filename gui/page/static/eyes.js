// Shows the pictures of both eyes, and that of the left one beside the head while *Follow* runs; the web socket for them
// is open only while they are visible.
import { isOpen } from "./connection.js";
import { byId } from "./parts.js";
import { text as textOf, view } from "./view.js";

const RETRY_MS = 1000;
let socket = null;
let shown = ""; // robot and side of the socket
let visible = false;
const beside = byId("eye");
const images = ["left_eye", "right_eye"].map((name) => {
  const figure = document.createElement("figure");
  const caption = document.createElement("figcaption");
  caption.dataset.text = `page.${name}`;
  const image = new Image();
  image.dataset.label = `page.${name}`;
  figure.append(image, caption);
  return image;
});

export function connectEyes() {
  document.querySelector("#eyes .pictures").append(...images.map((image) => image.parentElement));
  new IntersectionObserver((entries) => { visible = entries.at(-1).isIntersecting; showEyes(); }).observe(byId("eyes"));
}

export function showEyes() {
  if (!view.eyes) return;
  const { side, on, text, follows } = view.eyes;
  beside.hidden = !follows;
  byId("looking").checked = on;
  document.querySelector("#eyes .pictures").hidden = !on || Boolean(text);
  byId("eyes-hint").textContent = on ? text : textOf("page.eyes_off");
  const both = on && !text && visible;
  const wanted = (both || follows) && !document.hidden && isOpen() ? `robot=${view.robot}&side=${side}${both ? "" : "&eye=left"}` : "";
  if (wanted !== shown) open(wanted);
}

function open(wanted) {
  socket?.close();
  socket = null;
  shown = wanted;
  images.forEach((image) => { release(image); image.removeAttribute("src"); });
  beside.removeAttribute("src");
  if (!wanted) return;
  const own = socket = new WebSocket(`ws://${location.host}/pictures?${wanted}`);
  own.binaryType = "arraybuffer";
  own.onmessage = (event) => { if (own === socket) draw(own, event.data); };
  own.onclose = () => { if (own === socket) setTimeout(() => { if (own === socket) shown = ""; }, RETRY_MS); };
}

function draw(own, data) {
  const eye = new Uint8Array(data, 0, 1)[0];
  const image = images[eye];
  release(image);
  image.onload = image.onerror = () => { if (own.readyState === WebSocket.OPEN) own.send(String(eye)); };
  image.src = URL.createObjectURL(new Blob([new Uint8Array(data, 1)], { type: "image/jpeg" }));
  if (eye === 0) beside.src = image.src;
}

function release(image) {
  if (image.src) URL.revokeObjectURL(image.src);
}
