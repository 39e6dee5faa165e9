// The gallery of the class on the page for a projector: photos and films that pupils have shown, the newest first.
import { byId } from "./parts.js";
import { token } from "./view.js";

const LOOK_MS = 5000;
const SHOWN = 24; // as many as a tablet can hold
const items = new Map(); // by path
let texts = {}; // what holds the texts of the page
let teacher = false, looking = false, timer = 0;

// A film is fetched as a whole: Safari plays no film of a server that sends it in one piece only.
async function itemOf(path, name) {
  const item = document.createElement("li"), film = !path.endsWith(".png"), below = document.createElement("p");
  const picture = document.createElement(film ? "video" : "img");
  below.textContent = film ? `▶ ${name}` : name;
  Object.assign(picture, { loop: true, muted: true, playsInline: true, alt: name, tabIndex: 0 });
  item.append(picture, below);
  picture.onclick = () => {
    const large = item.classList.toggle("large");
    if (film) picture[large ? "play" : "pause"]();
  };
  picture.onkeydown = ({ key }) => { if (key === "Enter") picture.click(); };
  if (teacher) below.append(deleting(path));
  picture.src = film ? URL.createObjectURL(await (await fetch(path)).blob()) : path;
  return item;
}

function deleting(path) {
  const button = document.createElement("button");
  button.textContent = "✕";
  button.ariaLabel = button.title = texts.texts["page.show_delete"];
  button.onclick = async () => {
    if (!window.confirm(button.title)) return; // this page has no STOP that a dialog could hide
    await fetch(path, { method: "DELETE", headers: { "X-XSRFToken": token } });
    look();
  };
  return button;
}

export async function look() {
  if (!texts.texts["page.show"]) return; // the page is still opening
  const reply = await fetch("/gallery").catch(() => null);
  if (reply?.status === 403) clearInterval(timer); // there is no class
  if (!reply?.ok || looking) return;
  looking = true;
  await update(reply).catch(() => null); // the network was lost: the next look gets the rest
  looking = false;
  showGallery();
}

async function update(reply) {
  const found = await reply.json(), shown = found.shown.slice(0, SHOWN).map(([seat, file, name]) => [`/gallery/${seat}/${file}`, name]);
  teacher = found.teacher;
  const known = new Set(shown.map(([path]) => path));
  for (const path of items.keys()) if (!known.has(path)) items.delete(path);
  for (const [path, name] of shown) if (!items.has(path)) items.set(path, await itemOf(path, name));
  const list = shown.map(([path]) => items.get(path)), { children } = byId("gallery");
  if (list.length !== children.length || list.some((item, index) => item !== children[index])) byId("gallery").replaceChildren(...list);
}

function showGallery() {
  const open = !byId("gallery").hidden && items.size > 0;
  byId("gallery").hidden = !open;
  byId("turns").hidden = open;
  byId("pictures").hidden = items.size === 0;
  byId("pictures").textContent = open ? texts.texts["page.show_back"] : `${texts.texts["page.show_gallery"]} (${items.size})`;
}

export function connectGallery(view) {
  texts = view;
  byId("pictures").onclick = () => {
    byId("gallery").hidden = !byId("gallery").hidden;
    showGallery();
  };
  timer = setInterval(look, LOOK_MS);
}
