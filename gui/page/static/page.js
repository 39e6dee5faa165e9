// The control page: draws the parts of the view that its server sends, and sends the intent of each button.
import { ROTATIONS, aimBySlider, finishAim, showTarget } from "./aim.js";
import { BLOCKS, connectBlocks, disconnected } from "./blocks.js";
import { SEQUENCE } from "./cards.js";
import { connect, send, trouble } from "./connection.js";
import { connectEyes, showEyes } from "./eyes.js";
import { changed, connectHead, receivePose, showAround } from "./head.js";
import { connectHold, jogButton, releaseButton } from "./hold.js";
import { connectKeys } from "./keys.js";
import { LESSONS, asLesson, connectLessons } from "./lessons.js";
import { GUIDE, connectGuide } from "./guide.js";
import { connectGamepad } from "./gamepad.js";
import { bind, bothAngles, byId, choose, make, set, showRefusal } from "./parts.js";
import { connectShow, drawn } from "./show.js";
import { connectStop } from "./stop.js";
import { connectTabs } from "./tabs.js";
import { text, view } from "./view.js";

const SPEEDS = [10, 20, 30, 40, 60, 90]; // °/s
const LEADS = [0, 1, 2, 5]; // s
// Signs of the left and right button of a part of the head; yaw to the left is positive.
const SIGNS = { yaw: [1, -1], pitch: [-1, 1], roll: [-1, 1] };
const ARMS = ["short", "middle", "long"];
const COLUMNS = ["robot", "side", "state", "driver", "turn", "waiting", "rate", "age", "remarks"];
const BOXES = ["sim", "hw", "live", "send_on_release"];

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
  showEyes();
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
    if (part in SIGNS) set(button, text(`page.${button.id}`));
    button.ariaLabel = part in SIGNS ? text(`page.${button.id}`) : `${text(`arm.${part}`)} ${sign > 0 ? "+" : "−"}`;
  }
  showAround();
  document.querySelector("#class thead").replaceChildren(...COLUMNS.map((name) => make("th", text(`label.class_${name}`))));
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
  if (!you.drives) releaseButton();
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

function showHead(head) {
  showTarget(head);
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

// -- building -----------------------------------------------------------------------------------------

function named(kind, id, className = "") {
  const element = make(kind, "", className);
  element.id = id;
  return element;
}

function build() {
  for (const part of ROTATIONS) {
    const slider = named("input", `aim-${part}`), [left, right] = SIGNS[part];
    Object.assign(slider, { type: "range", step: 0.5, value: 0, oninput: () => { aimBySlider(part); changed(); } });
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

function hide() {
  releaseButton();
  send({ do: "hidden" });
}

build();
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
addEventListener("pagehide", hide);
document.addEventListener("visibilitychange", () => {
  if (!document.hidden) return showEyes();
  hide();
});
setInterval(showTrouble, 500);
connectStop();
connectKeys();
connectHold();
connectBlocks(asLesson);
connectLessons();
connectTabs();
connectGuide();
connectGamepad();
connectShow();
connectEyes();
connectHead(drawn);
connect(receive, receivePose, () => { releaseButton(); disconnected(); showTrouble(); });
