// What the server has sent, by the names of the parts of its view, and the sentences of the page in its language.
export const view = { texts: {}, you: {}, robot: "" };
export const token = document.querySelector("meta[name=token]").content;
export const text = (key, values = {}) => (view.texts[key] ?? "").replace(/\{(\w+)\}/g, (_, name) => values[name]);
