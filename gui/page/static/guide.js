// The strip above the head: the present step or mission, and after the last one the way to the lessons.
import { openTab } from "./tabs.js";

const byId = (id) => document.getElementById(id);
let bind; // shows a button of the view

export const GUIDE = { guide: show };

function show(guide) {
  byId("guide").hidden = !guide?.text;
  bind(byId("missions"), guide?.resume);
  if (!guide?.text) return;
  byId("guide").classList.toggle("good", Boolean(guide.good));
  byId("guide-dots").textContent = guide.progress;
  byId("guide-dots").ariaLabel = guide.count;
  if (byId("guide-text").textContent !== guide.text) byId("guide-text").textContent = guide.text;
  for (const name of ["hint", "skip", "close"]) bind(byId(`guide-${name}`), guide[name]);
  byId("guide-lessons").hidden = Boolean(guide.skip);
}

export function connectGuide(own) {
  bind = own.bind;
  byId("guide-lessons").onclick = () => openTab("lessons");
}
