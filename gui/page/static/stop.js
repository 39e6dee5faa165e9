// STOP: its button, and the sentence about it.
import { send, trouble } from "./connection.js";
import { releaseButton } from "./hold.js";
import { byId, set } from "./parts.js";
import { text, token, view } from "./view.js";

export function stop() {
  releaseButton();
  const robot = view.robot;
  if (!robot) return;
  const message = { do: "stop", robot, stop: crypto.getRandomValues(new Uint32Array(2)).join("-") };
  const sent = send(message) && !trouble();
  showStop(sent);
  // STOP is also sent by an HTTP request, in case the web socket is broken; the server carries it out once.
  fetch("/stop", {
    method: "POST", keepalive: true, headers: { "X-XSRFToken": token }, body: JSON.stringify(message),
  }).then((response) => { if (response.ok && !sent) showStop(true); }, () => {});
}

function showStop(sent) {
  set(byId("last"), text(sent ? "page.stop_sent" : "page.stop_failed", { robot: view.robot }));
  byId("last").className = sent ? "" : "bad";
}

export function connectStop() {
  byId("stop").onpointerdown = stop;
  byId("stop").onclick = (event) => { if (!event.pointerType || event.detail === 0) stop(); }; // by an assistive program
}
