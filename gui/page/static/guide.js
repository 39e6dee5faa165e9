// The strip above the head: the present step or mission, and after the last one the way to the lessons.
import { bind, byId } from "./parts.js";
import { openTab } from "./tabs.js";

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

export function connectGuide() {
  byId("guide-lessons").onclick = () => openTab("lessons");
}
