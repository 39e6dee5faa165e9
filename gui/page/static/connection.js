// The web socket to the server: messages in both directions, and whether the server answers.
const LOST_MS = 1500; // time without a view after which the server is lost; it sends at least two a second
const RETRY_MS = 1000;
const MALFORMED = 4002;

let socket = null;
let heard = 0; // time (ms) of the last view
let sent = 0; // times (ms) of the last message, and of the last one that was no heartbeat and no confirmation
let requested = 0;
let lost = ""; // key of a text; empty: connected, or not yet

export function send(message) {
  if (!isOpen()) return false;
  socket.send(JSON.stringify(message));
  if (message.do === "seen") return true;
  sent = performance.now();
  if (message.do !== "beat") requested = sent;
  return true;
}

export const sinceSent = () => performance.now() - sent; // ms
export const sinceRequest = () => performance.now() - requested; // ms

export function isOpen() {
  return socket?.readyState === WebSocket.OPEN;
}

// Returns the key of the sentence about a lost connection; empty: connected, or not yet.
export function trouble() {
  return lost || (heard && (!isOpen() || performance.now() - heard > LOST_MS) ? "page.lost" : "");
}

export function connect(receive, receivePose, closed) {
  const opened = socket = new WebSocket(`ws://${location.host}/live${location.pathname === "/class" ? "?watch" : ""}`);
  opened.binaryType = "arraybuffer";
  let answered = false;
  opened.onopen = () => {
    send({ do: "open", saved: savedChoices() });
    const robot = sessionStorage.getItem("robot");
    if (robot) send({ do: "ChooseRobot", name: robot });
  };
  opened.onmessage = (event) => {
    answered = true;
    heard = performance.now();
    if (typeof event.data !== "string") return receivePose(event.data);
    send({ do: "seen" });
    const parts = JSON.parse(event.data);
    if (parts.saved) localStorage.setItem("saved", JSON.stringify(parts.saved));
    receive(parts);
  };
  opened.onclose = (event) => {
    heard ||= 1;
    if (event.code === MALFORMED) localStorage.removeItem("saved");
    if (event.code > 4000) lost = "page.closed";
    else setTimeout(() => (answered ? connect : checkLogin)(receive, receivePose, closed), RETRY_MS);
    closed();
  };
}

function savedChoices() {
  try {
    const saved = JSON.parse(localStorage.getItem("saved"));
    if (saved) return saved;
  } catch { /* another program has written it */ }
  return { language: navigator.language.slice(0, 2) };
}

async function checkLogin(...receivers) {
  // A restarted server does not know the cookie: it replies with the form for the PIN or a redirect. Then reload.
  try {
    const page = await fetch("/", { redirect: "manual" });
    const html = await page.text();
    if (page.type === "opaqueredirect" || !html.includes('name="token"')) location.reload();
  } catch { /* the server does not answer yet */ }
  connect(...receivers);
}
