// The control page: draws the parts of the view that its server sends, and sends the intent of each button.
import { BLOCKS, connectBlocks, disconnected } from "./blocks.js";
import { SEQUENCE, connectCards } from "./cards.js";
import { connect, isOpen, send, sinceRequest, sinceSent, trouble } from "./connection.js";
import { connectEyes, showEyes } from "./eyes.js";
import { changed, connectHead, receivePose, seenFromFront } from "./head.js";
import { LESSONS, asLesson, connectLessons } from "./lessons.js";
import { GUIDE, connectGuide } from "./guide.js";
import { connectGamepad } from "./gamepad.js";
import { connectShow, drawn } from "./show.js";
import { connectTabs } from "./tabs.js";

const BEAT_MS = 100; // period of the heartbeats of a page whose robots move, or may move after a message
const REST_MS = 500; // period of the heartbeats of a page that drives or waits, and moves nothing
const BEGIN_MS = 3000; // time after a message in which a motion begins
const AIM_MS = 60; // shortest time between two targets
const CONFIRM_MS = 5000;
const SPEEDS = [10, 20, 30, 40, 60, 90]; // °/s
const LEADS = [0, 1, 2, 5]; // s
// Parts of the head with the signs of their left and right button; yaw to the left is positive.
const ROTATIONS = { yaw: [1, -1], pitch: [-1, 1], roll: [-1, 1] };
const ARMS = ["short", "middle", "long"];
const COLUMNS = ["robot", "side", "state", "driver", "turn", "waiting", "rate", "age", "remarks"];
const KEYS = {
  ArrowLeft: "yaw-plus", ArrowRight: "yaw-minus", ArrowUp: "pitch-minus", ArrowDown: "pitch-plus",
  KeyA: "yaw-plus", KeyD: "yaw-minus", KeyW: "pitch-minus", KeyS: "pitch-plus", KeyQ: "roll-minus", KeyE: "roll-plus",
};
const BOXES = ["sim", "hw", "live", "send_on_release"];
const WATCHERS = ["ChooseRobot", "DismissNotice", "DismissRefusal", "EmergencyStop", "AddPose", "DeletePose", "SetDuration", "MovePose", "UndoSequence", "AimHead", "EndBlocks", "Govern", "LimitClass"];

const byId = (id) => document.getElementById(id);
const token = document.querySelector("meta[name=token]").content;
const view = { texts: {}, you: {}, robot: "" };
let held = null; // the button that is held
let aimed = -1e6; // time (ms) of the last move of a slider or of the head
let wanted = null; // the target of that move

const text = (key, values = {}) => (view.texts[key] ?? "").replace(/\{(\w+)\}/g, (_, name) => values[name]);

// -- small parts --------------------------------------------------------------------------------------

function set(element, content) {
  if (element.textContent !== content) element.textContent = content;
}

function make(kind, content = "", className = "") {
  const element = document.createElement(kind);
  element.textContent = content;
  element.className = className;
  return element;
}

// Shows a button of the view; `more` returns fields of its intent that the page knows.
function bind(element, button, more = () => ({})) {
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

function choose(list, values, value, name) {
  const all = [...new Set([...values, value])].sort((a, b) => a - b);
  if (list.dataset.values !== all.join()) {
    list.dataset.values = all.join();
    list.replaceChildren(...all.map((one) => new Option(name(one), one)));
  }
  if (document.activeElement !== list) list.value = value;
}

function showRefusal(id, refusal) {
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

// -- the parts of the view ----------------------------------------------------------------------------

const SHOW = {
  title: (title) => { document.title = title; },
  language: (language) => { document.documentElement.lang = byId("language").value = language; },
  texts: showTexts,
  robots: showRobots,
  robot: showRobots,
  you: showYou,
  banner: (banner) => {
    byId("banner").hidden = !banner;
    const buttons = banner?.buttons.map((button) => bind(make("button"), button)) ?? [];
    byId("banner").replaceChildren(make("p", banner?.text), ...buttons);
  },
  pills: (pills) => pills.forEach(showPill),
  head: showHead,
  border: changed,
  gestures: showGestures,
  arms: showArms,
  choices: showChoices,
  sending: showSending,
  commands: (commands) => {
    for (const [name, button] of Object.entries(commands.buttons)) if (byId(name)) bind(byId(name), button);
    showRefusal("refusal-commands", commands.refusal);
  },
  history: (rows) => byId("history").replaceChildren(...rows.map(historyRow)),
  class: (rows) => {
    const cells = (row) => row.cells.map((cell) => make("td", cell));
    document.querySelector("#class tbody").replaceChildren(...rows.map((row, index) => {
      const line = make("tr"), buttons = make("td");
      for (const button of view.govern?.rows[index] ?? []) buttons.append(bind(make("button"), button), " ");
      line.append(...cells(row), buttons);
      return line;
    }));
  },
  govern: showGovern,
  last: (last) => set(byId("last"), last),
  stop: (button) => {
    byId("stop").title = button.tooltip;
    set(byId("stop"), view.robots?.length > 1 ? `${button.text} ${view.robot}` : button.text);
  },
  emergency: (button) => bind(byId("emergency"), button),
  ...GUIDE,
  ...SEQUENCE,
  ...BLOCKS,
  ...LESSONS,
};

function receive(parts) {
  Object.assign(view, parts);
  const names = parts.texts ? Object.keys(view) : Object.keys(parts);
  for (const name of ["texts", ...Object.keys(SHOW)]) if (names.includes(name)) SHOW[name](view[name]);
  showEyes(view);
  showTrouble();
}

function showTexts() {
  for (const element of document.querySelectorAll("[data-text]")) set(element, text(element.dataset.text));
  for (const element of document.querySelectorAll("[data-label]")) {
    element.ariaLabel = element.title = text(element.dataset.label);
    if (element.tagName === "INPUT") element.placeholder = element.title;
  }
  for (const button of document.querySelectorAll("[data-part]")) {
    const { part, sign } = button.dataset;
    if (part in ROTATIONS) set(button, text(`page.${button.id}`));
    button.ariaLabel = part in ROTATIONS ? text(`page.${button.id}`) : `${text(`arm.${part}`)} ${sign > 0 ? "+" : "−"}`;
  }
  showAround();
  document.querySelector("#class thead").replaceChildren(...COLUMNS.map((name) => make("th", text(`label.class_${name}`))));
}

function showAround() {
  set(byId("around"), text(seenFromFront() ? "page.from_behind" : "page.from_front"));
}

// The teacher's page governs the class.
function showGovern(govern) {
  const first = govern && byId("govern").hidden;
  byId("govern").hidden = !govern;
  if (!govern) return;
  if (first) { // what a teacher needs first
    byId("class").open = true;
    byId("class").parentElement.prepend(byId("class"));
  }
  const [freeze, unfreeze, limit] = govern.all;
  bind(byId("freeze-all"), freeze);
  bind(byId("unfreeze-all"), unfreeze);
  bind(byId("limit"), limit, () => ({ text: byId("limit-speed").value }));
  ["summary", "limit-now", "governed"].forEach((id, index) => set(byId(id), govern.texts[index]));
  byId("seats").replaceChildren(...govern.seats.flatMap(([name, button]) => [make("span", name), bind(make("button"), button)]));
}

function showTrouble() {
  const key = trouble();
  byId("trouble").hidden = !key;
  set(byId("trouble"), text(key));
  document.body.classList.toggle("lost", Boolean(key));
}

function showRobots() {
  if (view.robot) sessionStorage.setItem("robot", view.robot); // for the next connection
  const names = [...new Set([...(view.robots ?? []), view.robot])].sort();
  const list = byId("robots");
  if (list.dataset.names !== names.join()) {
    list.dataset.names = names.join();
    list.replaceChildren(...names.map((name) => new Option(name, name)));
  }
  if (document.activeElement !== list) list.value = view.robot;
}

function showYou(you) {
  if (held && !you.drives) releaseButton();
  set(byId("you"), you.text);
  set(byId("drive"), text(you.drives ? "page.leave" : "page.drive"));
  byId("drive").title = text(you.drives ? "page.leave_tip" : "page.drive_tip");
  byId("drive").classList.toggle("main", !you.drives);
  byId("name").hidden = you.drives || Boolean(you.name); // the seat of a class has a name
  document.body.classList.toggle("idle", !you.drives);
  byId("beside").hidden = !you.beside;
  byId("beside").ariaLabel = byId("beside").title = byId("beside").lastChild.textContent = you.beside;
  document.body.classList.toggle("own", you.name !== "" && you.seat === view.robot);
  set(byId("notice"), you.notice);
  byId("notice").hidden = !you.notice;
}

function showPill(pill, index) {
  const box = byId("pills").children[index];
  const [state, notes, button] = box.children;
  box.className = `pill ${pill.condition.replace(" ", "-")}`;
  box.title = [pill.reason, ...pill.warnings, pill.details].filter(Boolean).join("\n");
  set(state, `${pill.symbol} ${pill.title}: ${pill.text}`);
  set(notes, [...pill.notes, ...pill.warnings, pill.latency].filter(Boolean).join(" · "));
  bind(button, pill.next_step ?? pill.lease);
  button.classList.toggle("next", Boolean(pill.next_step));
}

// A line may end between the robots, not between a robot and its angle.
function bothAngles(angle) {
  const sides = ["sim", "hw"].filter(angle);
  if (sides.length === 1) return angle(sides[0]);
  return sides.map((side) => `${text(`label.${side}`)}\u00a0${angle(side)}`).join("\u2002");
}

function showHead(head) {
  const signed = (angle) => `${(Math.round(10 * angle) / 10 || 0).toFixed(1).replace("-", "−")}°`.replace(".", view.language === "de" ? "," : ".");
  for (const part of Object.keys(ROTATIONS)) {
    const slider = byId(`aim-${part}`);
    const most = part === "yaw" ? head.yaw_max : head.tilt_max;
    slider.max = most;
    slider.min = -most;
    slider.value = target()[part] * direction(part);
    set(byId(`value-${part}`), bothAngles((side) => head[side] && signed(head[side][part])));
    set(byId(`target-${part}`), `${text(`label.${part}`)} ${signed(target()[part])}`);
    slider.ariaLabel = text(`label.${part}`);
    slider.ariaValueText = signed(target()[part]);
  }
  bind(byId("send"), head.send);
  showRefusal("refusal-head", head.refusal);
  byId("no-head").hidden = Boolean(head.shown);
  byId("around").hidden = !head.shown;
  const both = head.sim && head.hw ? [head.solid, head.solid === "sim" ? "hw" : "sim"] : [];
  byId("sides").replaceChildren(...both.map((side, index) => make("span", `${"■□"[index]} ${text(`label.${side}`)}`, side)));
  changed();
}

function showGestures({ gestures, programs, deletes, refusal }) {
  const row = byId("gestures"), all = [...gestures, ...programs];
  if (row.children.length !== all.length) row.replaceChildren(...all.map(() => make("button")));
  all.forEach(([, emoji, button], index) => bind(row.children[index], { ...button, text: `${emoji}\n${button.text}`.trim() })
    .classList.toggle("next", button.intent.do === "EndProgram"));
  const own = byId("own");
  if (own.children.length !== deletes.length) own.replaceChildren(...deletes.map(() => make("button")));
  deletes.forEach(([name, button], index) => bind(own.children[index], { ...button, text: `✕ ${name}` }));
  showRefusal("refusal-gestures", refusal);
}

function showArms(arms) {
  for (const row of arms.rows.filter((one) => ARMS.includes(one.arm))) {
    set(byId(`name-${row.arm}`), row.title);
    set(byId(`value-${row.arm}`), bothAngles((side) => row[side] !== "–" && row[side]) || "–");
  }
  showRefusal("refusal-arms", arms.refusal);
  showChoices();
}

function showChoices() {
  const { choices, arms } = view;
  for (const name of BOXES) byId(name).checked = choices[name];
  choose(byId("speed"), SPEEDS.filter((speed) => speed <= arms.speed_max), choices.speed, (speed) => `${speed}${text("label.speed_unit")}`);
  choose(byId("lead"), LEADS, choices.lead_s, (lead) => `${lead}${text("label.lead_unit")}`);
}

function showSending(sending) {
  byId("lead-row").hidden = !sending.lead_matters;
  set(byId("plan-title"), sending.title);
  set(byId("plan-text"), sending.text);
  byId("waiting").hidden = sending.progress === null;
  byId("progress").value = sending.progress ?? 0;
  set(byId("countdown"), sending.countdown);
  byId("plan-buttons").hidden = !sending.abort.enabled;
  for (const name of ["send_now", "change", "abort"]) bind(byId(name), sending[name]);
}

function historyRow(row) {
  const line = make("li", "", row.on_purpose ? "" : row.good === false ? "bad" : row.good ? "good" : "");
  line.append(make("b", `${row.symbol} ${row.what}`), make("span", ` ${row.result}`), make("small", `${row.time} ${row.who}`));
  if (row.row >= 0) {
    const again = { text: "↻", tooltip: text("label.repeat"), intent: { do: "Repeat", row: row.row }, enabled: true };
    line.append(bind(make("button"), again));
  }
  return line;
}

// -- STOP ---------------------------------------------------------------------------------------------

function stop() {
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

// -- holding buttons ----------------------------------------------------------------------------------

function beat() {
  if (held) send({ do: "HoldArm", arm: held.dataset.part, sign: Number(held.dataset.sign) });
  else if (view.you.drives && (view.you.moves || sinceRequest() < BEGIN_MS || sinceSent() >= REST_MS)) send({ do: "beat" });
}

function pressButton(button) {
  releaseButton();
  held = button;
  beat();
  if (view.you.drives) button.classList.add("held");
  else held = null; // the server has replied with a sentence
}

function releaseButton() {
  if (!held) return;
  held.classList.remove("held");
  held = null;
  send({ do: "ReleaseArm" });
}

function hide() {
  releaseButton();
  send({ do: "hidden" });
}

function keys(event) {
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
  if (event.type === "keyup") { if (held === button) releaseButton(); } else if (!event.repeat) pressButton(button);
}

// -- the target of the head ---------------------------------------------------------------------------

const direction = (part) => (part === "yaw" ? -1 : 1); // a slider to the left turns the head to the left
// The newest move counts until the server has answered it.
const target = () => (aiming || dragging || performance.now() - aimed < 400 ? wanted : view.head.target);

function sendAim() {
  send({ do: "AimHead", ...wanted });
  if (dragging && view.you.drives && view.choices.live) send({ do: "LiveHead" });
}

let aiming = 0, dragging = false;
function aim(orientation) {
  wanted = orientation;
  aimed = performance.now();
  aiming ||= setTimeout(() => { aiming = 0; sendAim(); }, AIM_MS);
  showHead(view.head);
}

// The last target goes before the intent of the button *Send*.
function finishAim() {
  if (!aiming) return;
  clearTimeout(aiming);
  aiming = 0;
  sendAim();
}

function grab() {
  wanted = target();
  dragging = true;
  send({ do: "GrabHead" });
}

function releaseHead() {
  finishAim();
  dragging = false;
  if (view.you.drives) send({ do: "ReleaseHead" }); // it sends the target, if that was chosen
}

// -- building -----------------------------------------------------------------------------------------

function jogButton(part, sign) {
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

function named(kind, id, className = "") {
  const element = make(kind, "", className);
  element.id = id;
  return element;
}

function build() {
  for (const [part, [left, right]] of Object.entries(ROTATIONS)) {
    const slider = named("input", `aim-${part}`);
    const slide = () => aim({ ...target(), [part]: Number(slider.value) * direction(part) + 0 });
    Object.assign(slider, { type: "range", step: 0.5, value: 0, oninput: slide });
    slider.onkeydown = (event) => { if (event.key === "Enter") byId("send").click(); };
    const names = make("div", "", "angles");
    names.append(named("b", `target-${part}`), named("span", `value-${part}`));
    const both = make("div");
    both.append(names, slider);
    byId("rotations").append(jogButton(part, left), both, jogButton(part, right));
  }
  for (const arm of ARMS) {
    const names = make("div", "", "angles");
    names.append(named("b", `name-${arm}`), named("span", `value-${arm}`));
    byId("rows").append(jogButton(arm, -1), names, jogButton(arm, 1));
  }
  for (let index = 0; index < 2; index += 1) {
    const pill = make("div");
    pill.append(make("p"), make("small"), make("button"));
    byId("pills").append(pill);
  }
  byId("name").value = localStorage.getItem("name") ?? document.querySelector("meta[name=guest]").content;
}

function drive() {
  if (view.you.drives) {
    releaseButton();
    send({ do: "leave" });
    return;
  }
  const name = byId("name").value.trim() || "guest";
  localStorage.setItem("name", name);
  send({ do: "drive", name });
}

build();
byId("stop").onpointerdown = stop;
byId("stop").onclick = (event) => { if (!event.pointerType || event.detail === 0) stop(); }; // by an assistive program
byId("drive").onclick = drive;
byId("notice").onclick = () => { byId("notice").hidden = true; };
byId("send").addEventListener("click", finishAim, true);
byId("beside").onclick = () => send({ do: "ChooseRobot", name: view.you.beside });
byId("robots").onchange = (event) => { event.target.blur(); send({ do: "ChooseRobot", name: event.target.value }); };
const sendChoice = (name, value) => send({ do: "Choose", name, value });
byId("language").onchange = (event) => sendChoice("language", event.target.value);
byId("speed").onchange = (event) => sendChoice("speed", Number(event.target.value));
byId("lead").onchange = (event) => sendChoice("lead_s", Number(event.target.value));
for (const name of BOXES) byId(name).onchange = (event) => sendChoice(name, event.target.checked);
byId("looking").onchange = (event) => sendChoice("cameras", event.target.checked);
byId("class").ontoggle = (event) => send({ do: "class", on: event.target.open });
addEventListener("keydown", keys, true);
addEventListener("keyup", keys, true);
addEventListener("blur", releaseButton);
addEventListener("pagehide", hide);
document.addEventListener("visibilitychange", () => {
  if (!document.hidden) return showEyes(view);
  hide();
});
setInterval(beat, BEAT_MS);
setInterval(showTrouble, 500);
connectBlocks({ text, bind, view, asLesson });
connectLessons({ text, make, view });
connectTabs();
connectCards({ text, bind, make, view });
connectGuide({ bind });
connectGamepad({ view, stop });
connectShow({ text, view, token });
connectEyes(isOpen, () => showEyes(view));
connectHead({ view, target, aim, grab, release: releaseHead, turned: showAround, drawn });
connect(receive, receivePose, () => { releaseButton(); disconnected(); showTrouble(); });
