// The page for a projector: whose turn it is at each robot. It sends no request to a robot.
import { connect, send, trouble } from "./connection.js";
import { connectGallery, look } from "./gallery.js";
import { byId } from "./parts.js";

const READY = ["ready", "moving"]; // conditions in which a robot can move
const COLUMNS = [2, 8, 15, 24]; // largest number of robots in one column, in two, and so on; then in one more
const shown = { texts: {}, class: [] }; // the last view

function span(className, content) {
  const element = document.createElement("span");
  element.className = className;
  element.textContent = content;
  return element;
}

// The same cells as in the table of the control page; only their places differ.
function robot(row, mixed) {
  const [name, side, state, driver, left, waiting] = row.cells;
  const silent = row.condition === "silent", ready = READY.includes(row.condition);
  const item = document.createElement("li"), top = span("top", ""), notes = span("notes", "");
  item.classList.toggle("unready", !ready);
  notes.append(...[span("side", mixed ? side : ""), span("state", ready ? "" : state)].filter((note) => note.textContent));
  top.append(span("robot", name), notes, span("left", silent ? "" : left));
  const next = waiting && !silent ? shown.texts["page.next"].replace("{seats}", waiting) : "";
  item.append(top, span("driver", silent ? "" : driver || shown.texts["page.free"]), span("next", next));
  return item;
}

function overflows(element) {
  const tolerance = parseFloat(getComputedStyle(element).fontSize) / 2; // px; letters may reach out of their line
  return element.scrollWidth > element.clientWidth + 1 || element.scrollHeight > element.clientHeight + tolerance;
}

// Cuts a long text in the middle: names that begin with the same word often differ at the end.
function fit(element) {
  const text = element.textContent;
  if (!overflows(element)) return;
  const cut = (kept) => {
    element.textContent = `${text.slice(0, Math.ceil(kept / 2))}…${text.slice(text.length - Math.floor(kept / 2))}`;
  };
  let least = 1, most = text.length - 1;
  while (least < most) {
    const kept = Math.ceil((least + most) / 2);
    cut(kept);
    if (overflows(element)) most = kept - 1;
    else least = kept;
  }
  cut(least);
}

function draw() {
  const rows = shown.class, columns = 1 + COLUMNS.filter((most) => rows.length > most).length;
  const mixed = new Set(rows.map((row) => row.cells[1])).size > 1;
  byId("empty").textContent = shown.empty ?? "";
  byId("empty").hidden = rows.length > 0;
  byId("hint").textContent = shown.texts["page.stop_hint"] ?? "";
  byId("turns").style.setProperty("--columns", columns);
  byId("turns").style.setProperty("--lines", Math.max(1, Math.ceil(rows.length / columns)));
  byId("turns").replaceChildren(...rows.map((row) => robot(row, mixed)));
  document.querySelectorAll(".robot, .driver, .next").forEach(fit);
}

function show(parts) {
  Object.assign(shown, parts);
  if (parts.language) document.documentElement.lang = parts.language;
  if (parts.empty === null) send({ do: "class", on: true }); // a new connection
  if (parts.texts || parts.class || parts.empty) draw();
  if (parts.texts) look();
}

addEventListener("resize", draw);
setInterval(() => {
  const key = trouble();
  document.body.classList.toggle("lost", Boolean(key));
  byId("trouble").hidden = !key;
  byId("trouble").textContent = key ? shown.texts[key] ?? key : "";
}, 250);
connectGallery(shown);
connect(show, () => {});
