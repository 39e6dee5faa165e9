// The target of the head: its sliders, and a drag of the head, change it; *Send* sends it.
import { send } from "./connection.js";
import { byId, bothAngles, set } from "./parts.js";
import { text, view } from "./view.js";

const AIM_MS = 60; // shortest time between two targets
const ANSWER_MS = 400; // time in which the server answers a target
export const ROTATIONS = ["yaw", "pitch", "roll"];

let aimed = -1e6; // time (ms) of the last move of a slider or of the head
let wanted = null; // the target of that move
let aiming = 0, dragging = false;

const direction = (part) => (part === "yaw" ? -1 : 1); // a slider to the left turns the head to the left

// The newest move counts until the server has answered it.
export const targetNow = () => (aiming || dragging || performance.now() - aimed < ANSWER_MS ? wanted : view.head.target);

export function aim(orientation) {
  wanted = orientation;
  aimed = performance.now();
  aiming ||= setTimeout(() => { aiming = 0; sendAim(); }, AIM_MS);
  showTarget(view.head);
}

export function aimBySlider(part) {
  aim({ ...targetNow(), [part]: Number(byId(`aim-${part}`).value) * direction(part) + 0 });
}

function sendAim() {
  send({ do: "AimHead", ...wanted });
  if (dragging && view.you.drives && view.choices.live) send({ do: "LiveHead" });
}

// The last target goes before the intent of the button *Send*.
export function finishAim() {
  if (!aiming) return;
  clearTimeout(aiming);
  aiming = 0;
  sendAim();
}

export function grab() {
  wanted = targetNow();
  dragging = true;
  send({ do: "GrabHead" });
}

export function releaseHead() {
  finishAim();
  dragging = false;
  if (view.you.drives) send({ do: "ReleaseHead" }); // it sends the target, if that was chosen
}

// Shows the target and the orientations of the heads as sliders and numbers.
export function showTarget(head) {
  const signed = (angle) => `${(Math.round(10 * angle) / 10 || 0).toFixed(1).replace("-", "−")}°`.replace(".", view.language === "de" ? "," : ".");
  for (const part of ROTATIONS) {
    const slider = byId(`aim-${part}`), angle = targetNow()[part];
    const most = part === "yaw" ? head.yaw_max : head.tilt_max;
    slider.max = most;
    slider.min = -most;
    slider.value = angle * direction(part);
    set(byId(`value-${part}`), bothAngles((side) => head[side] && signed(head[side][part])));
    set(byId(`target-${part}`), `${text(`label.${part}`)} ${signed(angle)}`);
    slider.ariaLabel = text(`label.${part}`);
    slider.ariaValueText = signed(angle);
  }
}
