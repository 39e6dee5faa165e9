// Keys: Escape and the space bar are STOP; arrows and letters turn the head while they are held.
import { holds, pressButton, releaseButton } from "./hold.js";
import { byId } from "./parts.js";
import { stop } from "./stop.js";

const KEYS = {
  ArrowLeft: "yaw-plus", ArrowRight: "yaw-minus", ArrowUp: "pitch-minus", ArrowDown: "pitch-plus",
  KeyA: "yaw-plus", KeyD: "yaw-minus", KeyW: "pitch-minus", KeyS: "pitch-plus", KeyQ: "roll-minus", KeyE: "roll-plus",
};

function handle(event) {
  if (event.key === "Escape" || (event.key === " " && event.target.dataset?.words === undefined)) {
    event.preventDefault();
    if (event.type === "keydown" && !event.repeat) stop();
    return;
  }
  if (["INPUT", "SELECT"].includes(event.target.tagName) || document.querySelector("main").hidden) return;
  const named = !event.ctrlKey && !event.metaKey && byId(KEYS[event.code]);
  const button = named ?? (event.key === "Enter" && event.target.dataset?.part ? event.target : null);
  if (!button) return;
  event.preventDefault();
  if (event.type === "keyup") { if (holds(button)) releaseButton(); } else if (!event.repeat) pressButton(button);
}

export function connectKeys() {
  addEventListener("keydown", handle, true);
  addEventListener("keyup", handle, true);
}
