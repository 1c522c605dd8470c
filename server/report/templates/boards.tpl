{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../">Fleet</a> / <span>boards</span></nav>
<header>
<h1>Boards</h1>
<p class="meta">What people measured of calibration boards: all that robots say in metres rests on it.</p>
</header>
{{#LIST}}
<section class="card">
<p class="count" role="status">{{COUNT}}{{#DUE_COUNT}}, {{COUNT}} due for a check{{/DUE_COUNT}}</p>
<div class="scroll" tabindex="0" role="region" aria-label="Boards">
<table class="list">
<thead><tr><th scope="col">Serial</th><th scope="col">Pattern</th><th scope="col">Measured square</th><th scope="col">Flatness</th><th scope="col">Last check</th><th scope="col">Next check</th><th scope="col">Used in</th></tr></thead>
<tbody>
{{#BOARD}}<tr><th scope="row"><bdi>{{SERIAL}}</bdi></th><td class="text">{{PATTERN}}</td><td class="text">{{SIZE}}{{#ASSUMED}}<span class="soft">, assumed</span>{{/ASSUMED}}</td><td class="text">{{FLATNESS}}</td><td class="text">{{CHECKED}} <span class="soft">by <bdi>{{WHO}}</bdi></span></td><td class="text">{{#NEXT}}{{DAY}}{{#DUE}} <span class="badge warn">due</span> <code class="typed">{{COMMAND}}</code>{{/DUE}}{{/NEXT}}{{#NO_NEXT}}<span class="soft">none was set</span>{{/NO_NEXT}}</td><td class="text">{{SESSIONS}}</td></tr>
{{/BOARD}}
</tbody>
</table>
</div>
{{#CUT}}<p class="hint">There are more boards than the page shows: <code class="typed">rigcal board list</code></p>{{/CUT}}
<p class="hint">What depends on a board, and what was measured of it before: <code class="typed">rigcal board trace SERIAL</code>, <code class="typed">rigcal board show SERIAL</code></p>
</section>
{{/LIST}}
{{#UNREGISTERED}}
<section class="card">
<h2 id="unregistered">Not in the registry <span class="soft">sessions name them, nobody measured them</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="unregistered">
<table class="list">
<thead><tr><th scope="col">Serial</th><th scope="col">Pattern, as its newest session has it</th><th scope="col">Used in</th><th scope="col">What to do</th></tr></thead>
<tbody>
{{#BOARD}}<tr><th scope="row"><bdi>{{SERIAL}}</bdi></th><td class="text">{{PATTERN}}</td><td class="text">{{SESSIONS}}</td><td class="text"><code class="typed">{{COMMAND}}</code></td></tr>
{{/BOARD}}
</tbody>
</table>
</div>
</section>
{{/UNREGISTERED}}
{{#EMPTY}}
<section class="card empty">
<h2>No board is in the registry yet</h2>
<p>Print a board at true size, glue it flat, and measure both of its rulers:</p>
<pre><code>rigcal board print --type charuco --cols 11 --rows 8 --square-mm 25 --serial B-1 --out B-1.pdf</code></pre>
<pre><code>rigcal board measure B-1 --type charuco --cols 11 --rows 8 --square-mm 25 --ruler-x-mm A --ruler-y-mm B</code></pre>
<p>Then write <code>serial: B-1</code> into the board's target in <code>session.yaml</code>.</p>
</section>
{{/EMPTY}}
</main>
</body>
</html>
