// Small parts of the page: elements, buttons of the view, lists and refusals.
import { send } from "./connection.js";
import { text } from "./view.js";

const CONFIRM_MS = 5000;
const WATCHERS = ["ChooseRobot", "DismissNotice", "DismissRefusal", "EmergencyStop", "AddPose", "DeletePose", "SetDuration", "MovePose", "UndoSequence", "AimHead", "EndBlocks", "Govern", "LimitClass"];

export const byId = (id) => document.getElementById(id);

export function set(element, content) {
  if (element.textContent !== content) element.textContent = content;
}

export function make(kind, content = "", className = "") {
  const element = document.createElement(kind);
  element.textContent = content;
  element.className = className;
  return element;
}

// Shows a button of the view; `more` returns fields of its intent that the page knows.
export function bind(element, button, more = () => ({})) {
  element.hidden = !button;
  if (!button) return element;
  if (!element.classList.contains("armed")) set(element, button.text);
  element.title = button.tooltip;
  element.disabled = !button.enabled;
  element.classList.toggle("watching", !WATCHERS.includes(button.intent.do));
  element.onclick = () => {
    if (button.question && !element.classList.contains("armed")) confirm(element, button);
    else act(element, button, more());
  };
  return element;
}

function act(element, button, more) {
  if (button.question) disarm(element, button);
  send({ ...button.intent, ...more });
}

function disarm(element, button) {
  element.classList.remove("armed");
  element.textContent = button.text;
  byId("question").hidden = !document.querySelector(".armed");
}

// A second press must confirm. A dialog would hide STOP.
function confirm(element, button) {
  element.classList.add("armed");
  element.textContent = text("page.confirm");
  set(byId("question"), button.question);
  byId("question").hidden = false;
  setTimeout(() => disarm(element, button), CONFIRM_MS);
}

export function choose(list, values, value, name) {
  const all = [...new Set([...values, value])].sort((a, b) => a - b);
  if (list.dataset.values !== all.join()) {
    list.dataset.values = all.join();
    list.replaceChildren(...all.map((one) => new Option(name(one), one)));
  }
  if (document.activeElement !== list) list.value = value;
}

export function showRefusal(id, refusal) {
  const box = byId(id), content = JSON.stringify(refusal);
  box.hidden = !refusal;
  // A button that is replaced between press and release reports no click.
  if (!refusal || box.dataset.content === content) return;
  box.dataset.content = content;
  const close = { text: "✕", tooltip: text("label.dismiss"), intent: { do: "DismissRefusal" }, enabled: true };
  box.replaceChildren(make("p", refusal.text), bind(make("button"), close));
  if (refusal.alternative) box.append(bind(make("button", "", "main alternative"), refusal.alternative));
  box.scrollIntoView({ block: "nearest" }); // above STOP, and below the header
}

// A line may end between the robots, not between a robot and its angle.
export function bothAngles(angle) {
  const sides = ["sim", "hw"].filter(angle);
  if (sides.length === 1) return angle(sides[0]);
  return sides.map((side) => `${text(`label.${side}`)}\u00a0${angle(side)}`).join("\u2002");
}
