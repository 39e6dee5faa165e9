// The sequence: a card with a picture for each pose; the chosen one is gone to, moved, timed or deleted.
import { send } from "./connection.js";
import { portrait } from "./head.js";
import { bind, byId, make } from "./parts.js";
import { text, view } from "./view.js";

const STEP_S = 0.2; // change of a duration by one press
const LEAST_S = 0.1;

let chosen = ""; // name of the chosen card

export const SEQUENCE = { sequence: showSequence };

function showSequence({ cards, add, play, hardware, undo, played }) {
  const list = byId("cards");
  const shown = JSON.stringify([cards, played]);
  if (list.dataset.shown !== shown) { // a card that is replaced between press and release reports no click
    list.dataset.shown = shown;
    list.replaceChildren(...cards.map((card, index) => cardOf(card, index === played)));
    if (!cards.length) list.append(make("li", text("label.poses_empty"), "hint"));
  }
  choose(cards);
  const at = cards.findIndex((card) => card.name === chosen), card = cards[at];
  byId("card-buttons").hidden = !card;
  if (card) {
    const own = (id, label, intents, enabled = true) => {
      bind(byId(id), { text: text(label), tooltip: text(`${label}_tip`), intent: { do: "AimHead" }, enabled });
      byId(id).onclick = () => intents.forEach(send);
    };
    const lasts = (change) => ({ do: "SetDuration", name: card.name, seconds: Math.max(LEAST_S, Math.round(10 * (card.duration_s + change)) / 10) });
    own("go", "page.go", [{ do: "AimHead", ...card.head }, { do: "SendHead" }], Boolean(card.head));
    byId("go").classList.add("watching");
    own("earlier", "page.earlier", [{ do: "MovePose", name: card.name, to: at - 1 }], at > 0);
    own("later", "page.later", [{ do: "MovePose", name: card.name, to: at + 1 }], at < cards.length - 1);
    own("shorter", "page.shorter", [lasts(-STEP_S)], card.duration_s > LEAST_S);
    own("longer", "page.longer", [lasts(STEP_S)]);
    own("delete", "page.delete", [{ do: "DeletePose", name: card.name }]);
    byId("problem").textContent = card.problem;
  }
  bind(byId("add"), add, () => ({ name: byId("pose-name").value }));
  bind(byId("take-back"), undo);
  const gesture = { text: text("sequence.gesture"), tooltip: text("sequence.gesture_tip"), intent: { do: "SaveGesture" }, enabled: true };
  byId("gesture-row").hidden = !cards.length;
  bind(byId("as-gesture"), gesture, () => ({ name: byId("gesture-name").value, emoji: byId("gesture-emoji").value }));
  bind(byId("play"), play);
  bind(byId("hardware"), hardware);
}

function cardOf({ name, head, duration, problem }, played) {
  const line = make("li"), button = make("button", "", problem ? "card bad" : "card");
  const picture = document.createElement("canvas");
  button.dataset.name = name;
  button.classList.toggle("played", played);
  button.append(picture, make("b", name), make("small", problem ? `⚠ ${duration}` : duration));
  button.onclick = () => { chosen = name; showSequence(view.sequence); };
  line.append(button);
  if (head) portrait(picture, head);
  return line;
}

function choose(cards) {
  if (!cards.some((card) => card.name === chosen)) chosen = cards.at(-1)?.name ?? "";
  for (const button of byId("cards").querySelectorAll("button")) button.ariaPressed = String(button.dataset.name === chosen);
}
