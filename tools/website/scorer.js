// Sphinx's scores of matches, but decisions last and how-to pages before others: most readers search for what to do.
// First are the pages that explain a word, then the Python object of exactly this name.
const asked = new URLSearchParams(location.search).get("q")?.trim() ?? "";
const EXPLAINED = new Map([
  ["lease", ["docs/how-to/share-a-robot", "docs/explanation/glossary"]],
  ["msgpack", ["docs/reference/messages", "docs/reference/keys"]],
]);
const explains = (page) => EXPLAINED.get(asked.toLowerCase())?.includes(page);
// A word without a capital or a point, such as "stop", is more often a topic than a name.
const names = (title) =>
  asked.includes(".") ? `.${title}`.toLowerCase().endsWith(`.${asked.toLowerCase()}`)
    : /^[A-Z]/.test(asked) && title.endsWith(`.${asked}`);
// `var`, because Sphinx declares it, too.
var Scorer = {
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
  score: ([page, title, anchor, description, score]) =>
    score + (page.includes("/decisions/") ? -20 : page.includes("/how-to/") ? 3 : 0)
    + (explains(page) && !description ? 50 : description && names(title) ? 25 : 0),
};
