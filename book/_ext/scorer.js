// A chapter before the names of the library, which all contain "doppler"; read by the search page.
var Scorer = {
  objNameMatch: 5,
  objPartialMatch: 0,
  objPrio: { 0: 0, 1: 0, 2: -5 },
  objPrioDefault: 0,
  title: 20,
  partialTitle: 10,
  term: 5,
  partialTerm: 2,
  // A section of a chapter whose title has the words comes before pages with one of them in a title.
  score: ([page, title, , , score]) => score + (title.includes(" > ") && !page.startsWith("reference/") ? 10 : 0),
};
// Excerpts are fetched from the pages, which a browser refuses for files.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
