// Tables that sort and filter. Without this script they are plain tables in the order that matters most.
import { makeSortable } from "./tables/sorting.js";
import { addFilter } from "./tables/filter.js";
import { addContents, addOpenAll, openTarget } from "./tables/contents.js";
import { openForPaper } from "./tables/paper_folds.js";
import { closeWaysOut } from "./tables/on_disk.js";
import { tellOfNewer } from "./tables/newest.js";
import { watchOverdue } from "./overdue.js";

for (const table of document.querySelectorAll("table[data-sortable]")) makeSortable(table);
for (const table of document.querySelectorAll("table[data-filter]")) addFilter(table);
if (location.protocol === "file:") {
  closeWaysOut();
  watchOverdue(0);
} else tellOfNewer();
addOpenAll(document.getElementById("details"));
openForPaper();
addContents();
openTarget();
// A part that a script drew.
document.addEventListener("rigcal:parts", addContents);
window.addEventListener("hashchange", openTarget);
