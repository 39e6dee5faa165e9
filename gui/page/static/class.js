// The page for a projector: whose turn it is at each robot. It sends no request to a robot.
import { connect, send, trouble } from "./connection.js";

const byId = (id) => document.getElementById(id);
let texts = {};
let shown = null; // the last view of the class

function span(className, content) {
  const element = document.createElement("span");
  element.className = className;
  element.textContent = content;
  return element;
}

function robot(row) {
  const item = document.createElement("li"), top = span("top", ""), notes = span("notes", "");
  item.classList.toggle("unready", Boolean(row.state));
  notes.append(...[span("side", row.side), span("state", row.state)].filter((note) => note.textContent));
  top.append(span("robot", row.robot), notes, span("left", row.left));
  item.append(top, span("driver", row.driver), span("next", row.waiting));
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
  if (!shown) return;
  const { rows, columns, lines, empty, stop } = shown;
  byId("empty").textContent = empty;
  byId("empty").hidden = !empty;
  byId("hint").textContent = stop;
  byId("turns").style.setProperty("--columns", columns);
  byId("turns").style.setProperty("--lines", lines);
  byId("turns").replaceChildren(...rows.map(robot));
  document.querySelectorAll(".robot, .driver, .next").forEach(fit);
}

function show(parts) {
  texts = parts.texts ?? texts;
  if (parts.language) document.documentElement.lang = parts.language;
  if (parts.projector === null) send({ do: "class", on: true }); // a new connection
  if (!parts.projector) return;
  shown = parts.projector;
  draw();
}

addEventListener("resize", draw);
setInterval(() => {
  const key = trouble();
  document.body.classList.toggle("lost", Boolean(key));
  byId("trouble").hidden = !key;
  byId("trouble").textContent = key ? texts[key] ?? key : "";
}, 250);
connect(show, () => {});
