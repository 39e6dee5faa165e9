// Holding a button turns an arm or the head until it is released; heartbeats tell the server that the page is there.
import { send, sinceRequest, sinceSent } from "./connection.js";
import { make } from "./parts.js";
import { view } from "./view.js";

const BEAT_MS = 100; // period of the heartbeats of a page whose robots move, or may move after a message
const REST_MS = 500; // period of the heartbeats of a page that drives or waits, and moves nothing
const BEGIN_MS = 3000; // time after a message in which a motion begins

let held = null; // the button that is held

function beat() {
  if (held) send({ do: "HoldArm", arm: held.dataset.part, sign: Number(held.dataset.sign) });
  else if (view.you.drives && (view.you.moves || sinceRequest() < BEGIN_MS || sinceSent() >= REST_MS)) send({ do: "beat" });
}

export function pressButton(button) {
  releaseButton();
  held = button;
  beat();
  if (view.you.drives) button.classList.add("held");
  else held = null; // the server has replied with a sentence
}

export const holds = (button) => held === button;

export function releaseButton() {
  if (!held) return;
  held.classList.remove("held");
  held = null;
  send({ do: "ReleaseArm" });
}

export function jogButton(part, sign) {
  const button = make("button", sign > 0 ? "+" : "−");
  button.id = `${part}-${sign > 0 ? "plus" : "minus"}`;
  button.dataset.part = part;
  button.dataset.sign = sign;
  button.onpointerdown = (event) => {
    if (event.button) return;
    button.setPointerCapture(event.pointerId); // so that the release arrives even outside the button
    pressButton(button);
  };
  button.onpointerup = button.onpointercancel = button.onlostpointercapture = releaseButton;
  button.oncontextmenu = (event) => event.preventDefault();
  return button;
}

export function connectHold() {
  addEventListener("blur", releaseButton);
  setInterval(beat, BEAT_MS);
}
