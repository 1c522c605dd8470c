// A report is of one revision. Where the robot has a newer one by now, the page says so: its verdict is no longer the robot's.

export async function tellOfNewer() {
  const here = location.pathname.match(/\/robots\/([^/]+)\/revisions\/(\d+)\/(index\.html)?$/);
  const header = document.querySelector("main > header");
  if (!here || !header) return;
  try {
    const { revision } = await (await fetch("../../../../api/v1/live?robot=" + here[1])).json();
    if (!(revision > Number(here[2]))) return;
    const line = document.createElement("p"), link = document.createElement("a");
    line.className = "working";
    line.setAttribute("role", "status");
    link.href = `../${revision}/`;
    link.textContent = `Open revision ${revision}`;
    line.append(`This is an old report: the robot has revision ${revision} by now. `, link);
    header.append(line);
  } catch {
    // Nobody to ask: the report stands by itself.
  }
}
