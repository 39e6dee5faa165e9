// The strip above the head: the present step or mission, and after the last one the way to the lessons.
import { openTab } from "./tabs.js";

const byId = (id) => document.getElementById(id);
let page = null; // { bind, view }

export const GUIDE = { guide: show };

function show(guide) {
  const closed = localStorage.getItem("guide") === "closed"; // by this browser; what is done is kept with its choices
  byId("guide").hidden = !guide || closed;
  byId("missions").hidden = !guide || !closed;
  if (!guide) return;
  byId("guide").classList.toggle("good", Boolean(guide.good));
  byId("guide-dots").textContent = guide.progress;
  byId("guide-dots").ariaLabel = guide.count;
  if (byId("guide-text").textContent !== guide.text) byId("guide-text").textContent = guide.text;
  page.bind(byId("guide-hint"), guide.hint);
  page.bind(byId("guide-skip"), guide.skip);
  byId("guide-lessons").hidden = Boolean(guide.skip);
}

function close(closed) {
  localStorage.setItem("guide", closed ? "closed" : "open");
  show(page.view.guide);
}

export function connectGuide(own) {
  page = own;
  byId("guide-close").onclick = () => close(true);
  byId("missions").onclick = () => close(false);
  byId("guide-lessons").onclick = () => openTab("lessons");
}
