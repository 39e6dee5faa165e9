// A gamepad: its sticks turn the head, three buttons play gestures, and one is STOP.
import { send } from "./connection.js";
import { seenFromFront } from "./head.js";
import { byId } from "./parts.js";
import { stop } from "./stop.js";
import { view } from "./view.js";

const PERIOD_MS = 60;
const IDLE = 0.15; // deflection of a stick that nobody touches
const STOP = 1; // B or ○, in the standard mapping
const GESTURES = { 0: "yes", 2: "no", 3: "hello" }; // A, X and Y, or ✕, □ and △

let timer = 0, steers = false, pressed = new Set();

export function connectGamepad() {
  addEventListener("gamepadconnected", () => {
    byId("pad").hidden = false;
    timer ||= setInterval(read, PERIOD_MS);
  });
  document.addEventListener("visibilitychange", () => { if (document.hidden) rest(); });
}

const pads = () => navigator.getGamepads().filter((pad) => pad?.connected && pad.mapping === "standard"); // else nobody knows which axis is which
const deflection = (value = 0) => (Math.abs(value) < IDLE ? 0 : Math.sign(value) * (Math.abs(value) - IDLE) / (1 - IDLE));

// Left stick: turn and nod; right stick: tilt. The right of a stick is the right of the picture.
function read() {
  const [pad] = pads();
  if (!pad) {
    clearInterval(timer);
    timer = 0;
    byId("pad").hidden = true;
    return rest();
  }
  const [x, y, tilt] = pad.axes.map(deflection), side = seenFromFront() ? 1 : -1;
  const share = (value) => Math.max(-1, Math.min(1, value ?? 0)) + 0;
  if (!document.hidden && (x || y || tilt)) {
    steers = true;
    send({ do: "Steer", yaw: share(side * x), pitch: share(y), roll: share(-side * tilt) });
  } else rest();
  pad.buttons.forEach((button, index) => press(index, button.pressed));
}

function rest() {
  if (steers) send({ do: "ReleaseArm" });
  steers = false;
}

function press(index, down) {
  if (!down || pressed.has(index)) return down || pressed.delete(index);
  pressed.add(index);
  if (index === STOP) return stop();
  const [, button] = view.gestures?.gestures.find(([name]) => name === GESTURES[index]) ?? [];
  if (button?.enabled) send(button.intent);
}
