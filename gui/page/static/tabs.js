// The tabs of the page: each shows the panel of its name; the browser keeps which.
const byTab = (name) => document.querySelector(`#tabs [data-tab="${name}"]`);
const opened = {}; // what runs when a tab is opened, by its name

export function openTab(name) {
  const chosen = byTab(name) ? name : "drive";
  for (const tab of document.querySelectorAll("#tabs [data-tab]")) tab.setAttribute("aria-selected", tab.dataset.tab === chosen);
  for (const panel of document.querySelectorAll("[data-panel]")) panel.hidden = !panel.dataset.panel.split(" ").includes(chosen);
  document.body.dataset.tab = chosen;
  localStorage.setItem("tab", chosen);
  for (const run of opened[chosen] ?? []) run();
}

export function onTab(name, run) {
  (opened[name] ??= []).push(run);
}

export function connectTabs() {
  for (const tab of document.querySelectorAll("#tabs [data-tab]")) tab.onclick = () => openTab(tab.dataset.tab);
  openTab(localStorage.getItem("tab"));
}
