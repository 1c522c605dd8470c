// Tables that sort and filter. Without this script they are plain tables in the order that matters most.
import { makeSortable } from "./tables/sorting.js";
import { addFilter } from "./tables/filter.js";

for (const table of document.querySelectorAll("table[data-sortable]")) makeSortable(table);
for (const table of document.querySelectorAll("table[data-filter]")) addFilter(table);
