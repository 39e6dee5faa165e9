// Shows the pictures of both eyes; the web socket for them is open only while they are visible.
import { text } from "./texts.js";

const RETRY_MS = 1000;
let socket = null;
let shown = ""; // robot and side of the socket
let visible = false;
let connected = () => false;
const images = [0, 1].map((eye) => {
  const figure = document.createElement("figure");
  const image = new Image();
  image.alt = text(`eye.${eye}`);
  const caption = document.createElement("figcaption");
  caption.textContent = text(`eye.${eye}`);
  figure.append(image, caption);
  return image;
});

export function connectEyes(isConnected) {
  connected = isConnected;
  const place = document.querySelector("#eyes .pictures");
  place.append(...images.map((image) => image.parentElement));
  new IntersectionObserver((entries) => { visible = entries.at(-1).isIntersecting; }).observe(document.getElementById("eyes"));
}

export function showEyes(robot) {
  const looking = document.getElementById("looking").checked;
  const cameras = robot?.status?.eyes ?? [];
  const wanted = looking && visible && !document.hidden && cameras.length && connected() ? `${robot.robot} ${robot.side}` : "";
  let hint = "";
  if (robot?.status && !cameras.length) hint = "eyes.none";
  else if (!looking) hint = "eyes.off";
  else if (images.every((image) => !image.src)) hint = "eyes.waiting";
  document.getElementById("eyes-hint").textContent = hint && text(hint);
  document.querySelector("#eyes .pictures").hidden = !looking;
  if (wanted !== shown) open(wanted, robot);
}

function open(wanted, robot) {
  socket?.close();
  socket = null;
  shown = wanted;
  images.forEach((image) => { release(image); image.removeAttribute("src"); });
  if (!wanted) return;
  const own = socket = new WebSocket(`ws://${location.host}/pictures?robot=${robot.robot}&side=${robot.side}`);
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
}

function release(image) {
  if (image.src) URL.revokeObjectURL(image.src);
}
