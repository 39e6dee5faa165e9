// The control page: shows the state that its server sends, and sends a request for each button.
import { connectEyes, showEyes } from "./eyes.js";
import { text } from "./texts.js";

const BEAT_MS = 100; // period of the heartbeats of a page that drives or waits
const LOST_MS = 1500; // time without a state after which the server is lost; it sends ten a second
const RETRY_MS = 1000;
const CONFIRM_MS = 5000;
const SPEEDS = [10, 20, 40]; // °/s
const ROTATIONS = ["yaw", "pitch", "roll"];
const ARMS = ["short", "middle", "long"];
const FULL = 4004;
// Signs of the two buttons of each part. Yaw to the left, pitch nose-down and roll right-ear-down are positive.
const ROWS = [["yaw", 1, -1], ["pitch", -1, 1], ["roll", -1, 1], ["short", -1, 1], ["middle", -1, 1], ["long", -1, 1]];
const KEYS = { ArrowLeft: "yaw-plus", ArrowRight: "yaw-minus", ArrowUp: "pitch-minus", ArrowDown: "pitch-plus" };

const byId = (id) => document.getElementById(id);
const token = document.querySelector("meta[name=token]").content;
let socket = null;
let heard = 0; // time (ms) of the last state
let state = null; // the last state
let held = null; // the button that is held
let press = 0;
let closedFor = "";

// -- requests to the server ---------------------------------------------------------------------------------

function send(message) {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
}

function connect() {
  socket = new WebSocket(`ws://${location.host}/live`);
  const opened = socket;
  let answered = false;
  socket.onmessage = (event) => {
    if (opened !== socket) return;
    answered = true;
    receive(JSON.parse(event.data));
  };
  socket.onclose = (event) => {
    releaseButton();
    if (event.code === FULL) closedFor = text("trouble.full");
    else if (event.code > 4000) closedFor = text("trouble.closed");
    else setTimeout(answered ? connect : checkLogin, RETRY_MS);
    show();
  };
}

async function checkLogin() {
  // A restarted server does not know the cookie: it replies with the form for the PIN or a redirect. Then reload.
  try {
    const page = await fetch("/", { redirect: "manual" });
    const html = await page.text();
    if (page.type === "opaqueredirect" || !html.includes('name="token"')) location.reload();
  } catch { /* the server does not answer yet */ }
  connect();
}

function receive(message) {
  if (message.kind === "state") {
    state = message;
    heard = performance.now();
    send({ do: "seen" });
    show();
  } else if (message.kind === "hello") {
    if (!byId("name").value) byId("name").value = localStorage.getItem("name") ?? message.name;
  } else if (message.control === "stop") {
    showStop(message.ok, message.text);
  } else {
    report(message.control, message.ok, message.text);
  }
}

function report(control, ok, sentence) {
  for (const place of document.querySelectorAll(".refusal[data-for]")) {
    if (!place.dataset.for.split(" ").includes(control)) continue;
    place.hidden = ok;
    place.textContent = sentence;
  }
  if (!ok && held?.dataset.part === control) releaseButton();
}

function beat() {
  if (held) send({ do: "hold", press, part: held.dataset.part, sign: Number(held.dataset.sign), speed: speed() });
  else if (state?.you.drives || state?.you.waits) send({ do: "beat" });
}

// -- STOP ------------------------------------------------------------------------------------------

function stop() {
  releaseButton();
  const robot = state?.robot?.robot;
  if (!robot) return;
  const message = { do: "stop", robot, stop: crypto.getRandomValues(new Uint32Array(2)).join("-") };
  const sent = send(message) && condition()[0] !== "server";
  showStop(sent, text(sent ? "stop.sent" : "stop.failed", { robot }));
  // STOP is also sent by an HTTP request, in case the web socket is broken; the server carries it out once.
  fetch("/stop", {
    method: "POST", keepalive: true, headers: { "X-XSRFToken": token }, body: JSON.stringify(message),
  }).then((response) => { if (response.ok && !sent) showStop(true, text("stop.sent", { robot })); }, () => {});
}

function showStop(ok, sentence) {
  byId("stopped").textContent = sentence;
  byId("stopped").className = ok ? "" : "bad";
}

// -- holding buttons -------------------------------------------------------------------------------

function pressButton(button) {
  releaseButton();
  if (!state?.you.drives) {
    report(button.dataset.part, false, text("drive.first"));
    return;
  }
  report(button.dataset.part, true, "");
  report("drive", true, "");
  press += 1;
  held = button;
  button.classList.add("held");
  beat();
}

function releaseButton() {
  if (!held) return;
  held.classList.remove("held");
  held = null;
  send({ do: "release", press });
}

function hide() {
  releaseButton();
  send({ do: "hidden" });
}

function speed() {
  return Number(byId("speed").value);
}

// -- what the page shows ---------------------------------------------------------------------------

function condition() {
  const robot = state?.robot;
  if (!heard || performance.now() - heard > LOST_MS || socket?.readyState !== WebSocket.OPEN) return ["server", "bad"];
  if (!state.router) return ["router", "bad"];
  if (!robot) return ["none", "warn"];
  if (robot.presence === "absent") return ["absent", "bad"];
  if (robot.presence !== "online" || !robot.status) return ["silent", "bad"];
  if (robot.status.emergency) return ["emergency", "bad"];
  if (!robot.status.enabled) return ["off", "warn"];
  if (!robot.status.calibrated) return ["uncalibrated", "warn"];
  if (robot.status.frozen) return ["frozen", "warn"];
  return robot.status.moving ? ["moving", "good"] : ["ready", "good"];
}

function trouble(name) {
  const robot = state?.robot;
  const title = robot ? text(`robot.${robot.side}`, robot) : "";
  if (closedFor) return closedFor;
  if (name === "server") return heard || socket?.readyState === WebSocket.CLOSED ? text("trouble.server") : "";
  if (["router", "none"].includes(name)) return text(`trouble.${name}`);
  if (["absent", "silent"].includes(name)) {
    return text(`trouble.${name}`, { robot: title, seconds: (robot.age_s ?? 0).toFixed(1) });
  }
  const notes = [...robot.status.problems];
  if (robot.status.emergency) notes.unshift(text("trouble.emergency"));
  if (robot.status.frozen) notes.push(text("trouble.frozen"));
  if (robot.status.speed_limit) notes.push(text("trouble.limit", { speed: Math.round(robot.status.speed_limit) }));
  return notes.join(" ");
}

function show() {
  const [name, colour] = condition();
  set(byId("state"), text(`state.${name}`));
  byId("state").className = colour;
  const sentence = trouble(name);
  set(byId("trouble"), sentence);
  byId("trouble").hidden = !sentence;
  if (!state) return;
  showRobots();
  showDriver();
  showNumbers();
  const live = !["server", "router", "none"].includes(name);
  showEyes(live ? state.robot : null);
}

function set(element, content) {
  if (element.textContent !== content) element.textContent = content;
}

function showRobots() {
  const list = byId("robots");
  const places = state.robots.map((place) => `${place.robot} ${place.side}`);
  const own = state.robot ? `${state.robot.robot} ${state.robot.side}` : "";
  if (own && !places.includes(own)) places.unshift(own);
  if (list.dataset.places !== places.join(",")) {
    list.dataset.places = places.join(",");
    list.replaceChildren(...places.map((place) => {
      const [robot, side] = place.split(" ");
      return new Option(text(`robot.${side}`, { robot }), place);
    }));
    if (!places.length) list.replaceChildren(new Option(text("robot.none"), ""));
  }
  if (document.activeElement !== list) list.value = own;
  document.title = text("title", { robot: state.robot?.robot ?? text("robot.none") });
}

function showDriver() {
  const { you, robot } = state;
  const status = robot?.status;
  const seat = status?.holder ?? "";
  const number = (status?.waiting.indexOf(you.seat) ?? -1) + 1;
  let sentence = seat ? text("driver.other", { seat }) : text("driver.free");
  if (you.drives) sentence = text("driver.you", { seat: you.seat });
  else if (you.waits) sentence = number && seat ? text("driver.waiting", { seat, number }) : text("driver.opening");
  set(byId("driver"), sentence);
  const action = you.drives ? "leave" : you.waits ? "cancel" : seat ? "wait" : "take";
  set(byId("drive"), text(`drive.${action}`));
  byId("drive").classList.toggle("main", !you.drives);
  byId("name").hidden = you.drives || you.waits;
  document.body.classList.toggle("idle", !you.drives);
  document.querySelector("[data-command=ready]").classList.toggle(
    "next", Boolean(you.drives && status && !status.emergency && !(status.enabled && status.calibrated)));
  document.querySelector("[data-command=reset]").hidden = !status?.emergency;
  document.querySelector("[data-command=reset]").classList.toggle("next", you.drives);
}

function showNumbers() {
  const { head, arms } = state.robot ?? {};
  const values = [...(head ?? [null, null, null]), ...(arms ?? [null, null, null])];
  [...ROTATIONS, ...ARMS].forEach((part, index) => {
    const value = values[index];
    set(byId(`value-${part}`), value === null ? "–" : `${value.toFixed(1).replace("-", "−")}°`);
  });
}

// -- building --------------------------------------------------------------------------------------

function jogButton(part, sign) {
  const button = document.createElement("button");
  const way = `${part}${sign > 0 ? "+" : "-"}`;
  button.id = `${part}-${sign > 0 ? "plus" : "minus"}`;
  button.dataset.part = part;
  button.dataset.sign = sign;
  button.textContent = ARMS.includes(part) ? (sign > 0 ? "+" : "−") : text(`jog.${way}`);
  button.setAttribute("aria-label", text(`jog.${way}`));
  button.onpointerdown = (event) => {
    if (event.button) return;
    button.setPointerCapture(event.pointerId); // so that the release arrives even outside the button
    pressButton(button);
  };
  button.onpointerup = button.onpointercancel = button.onlostpointercapture = releaseButton;
  button.oncontextmenu = (event) => event.preventDefault();
  return button;
}

function build() {
  for (const [part, first, second] of ROWS) {
    const value = document.createElement("span");
    value.className = "value";
    value.innerHTML = `<span id="value-${part}">–</span><small>${text(`part.${part}`)}</small>`;
    const group = document.querySelector(ROTATIONS.includes(part) ? ".pad" : ".parts");
    group.append(jogButton(part, first), value, jogButton(part, second));
  }
  set(document.querySelector("#head h2"), text("head"));
  set(document.querySelector("#arms h2"), text("arms"));
  set(document.querySelector("#eyes h2"), text("eyes"));
  byId("hold-hint").textContent = text("hold");
  for (const button of document.querySelectorAll("[data-command]")) {
    button.textContent = text(`command.${button.dataset.command}`);
    button.onclick = () => command(button);
  }
  document.querySelector("[data-command=ready]").title = text("command.ready.tip");
  byId("home").textContent = text("command.home");
  byId("home").onclick = () => {
    report("home", true, "");
    send({ do: "home", speed: speed() });
  };
  byId("speed-title").textContent = text("speed");
  byId("speed").replaceChildren(...SPEEDS.map((value) => new Option(text("speed.of", { speed: value }), value)));
  byId("speed").value = SPEEDS[1];
  byId("stop").innerHTML = `${text("stop")}<small>${text("stop.keys")}</small>`;
}

function command(button) {
  const name = button.dataset.command;
  report(name, true, "");
  if (name === "disable" && state?.you.drives && !button.dataset.armed) {
    confirm(button);
    return;
  }
  send({ do: "command", command: name });
}

function confirm(button) {
  // The head sinks without power, so a second press must confirm. A dialog would hide STOP.
  button.dataset.armed = "yes";
  button.textContent = text("command.disable.again");
  report("disable", false, text("command.disable.note"));
  setTimeout(() => {
    delete button.dataset.armed;
    button.textContent = text("command.disable");
    if (document.querySelector("[data-for~=disable]").textContent === text("command.disable.note")) report("disable", true, "");
  }, CONFIRM_MS);
}

function drive() {
  const { you } = state ?? { you: {} };
  report("drive", true, "");
  if (you.drives || you.waits) {
    releaseButton();
    send({ do: "leave" });
    return;
  }
  const name = byId("name").value.trim() || "guest";
  localStorage.setItem("name", name);
  send({ do: "drive", name });
}

function keys(event) {
  if (event.key === " " || event.key === "Escape") {
    event.preventDefault();
    if (event.type === "keydown" && !event.repeat) stop();
    return;
  }
  if (["INPUT", "SELECT"].includes(event.target.tagName)) return;
  const named = KEYS[event.key] && byId(KEYS[event.key]);
  const button = named ?? (event.key === "Enter" && event.target.dataset?.part ? event.target : null);
  if (!button) return;
  event.preventDefault();
  if (event.type === "keyup") { if (held === button) releaseButton(); } else if (!event.repeat) pressButton(button);
}

build();
byId("stop").onpointerdown = stop;
byId("stop").onclick = (event) => { if (!event.pointerType || event.detail === 0) stop(); }; // by an assistive program
byId("drive").onclick = drive;
byId("robots").onchange = (event) => {
  const [robot, side] = event.target.value.split(" ");
  event.target.blur();
  if (side) send({ do: "watch", robot, side });
};
addEventListener("keydown", keys, true);
addEventListener("keyup", keys, true);
addEventListener("blur", releaseButton);
addEventListener("pagehide", hide);
document.addEventListener("visibilitychange", () => { if (document.hidden) hide(); });
setInterval(beat, BEAT_MS);
setInterval(show, 500);
connectEyes(() => socket?.readyState === WebSocket.OPEN);
connect();
