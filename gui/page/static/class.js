// The page for a projector: whose turn it is at each robot. It sends no request to a robot.
import { connect, send, trouble } from "./connection.js";

const byId = (id) => document.getElementById(id);
let texts = {};

function line(className, content) {
  const element = document.createElement("span");
  element.className = className;
  element.textContent = content;
  return element;
}

function show(parts) {
  texts = parts.texts ?? texts;
  if (parts.language) document.documentElement.lang = parts.language;
  if (parts.projector === null) send({ do: "class", on: true }); // a new connection
  if (!parts.projector) return;
  const { rows, empty, stop } = parts.projector;
  byId("empty").textContent = empty;
  byId("empty").hidden = !empty;
  byId("hint").textContent = stop;
  const columns = 1 + (rows.length > 3) + (rows.length > 8);
  byId("turns").className = `columns-${columns}`;
  byId("turns").style.setProperty("--lines", Math.max(1, Math.ceil(rows.length / columns)));
  byId("turns").replaceChildren(...rows.map((row) => {
    const item = document.createElement("li");
    item.classList.toggle("frozen", row.frozen);
    item.append(line("robot", row.robot), line("state", row.state), line("driver", row.driver),
      line("left", row.left), line("next", row.waiting));
    return item;
  }));
}

setInterval(() => {
  const key = trouble();
  document.body.classList.toggle("lost", Boolean(key));
  byId("trouble").hidden = !key;
  byId("trouble").textContent = key ? texts[key] ?? key : "";
}, 250);
connect(show, () => {});
