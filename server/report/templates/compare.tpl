{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../">Fleet</a> / <a href="./">{{ROBOT}}</a> / <span>compare</span></nav>
<header>
<h1>{{ROBOT}} <span class="soft">revision {{BEFORE}} and {{NOW}}</span></h1>
<p class="meta">{{#VERDICT_BEFORE}}<a href="revisions/{{NUMBER}}/">Revision {{NUMBER}}</a> <span class="badge {{LEVEL}}">{{WORD}}</span>{{/VERDICT_BEFORE}} &rarr; {{#VERDICT_NOW}}<a href="revisions/{{NUMBER}}/">Revision {{NUMBER}}</a> <span class="badge {{LEVEL}}">{{WORD}}</span>{{/VERDICT_NOW}}</p>
</header>
<form class="search" action="compare" method="get">
<label>Revision <select name="a">{{#CHOICE_A}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_A}}</select></label>
<label>with <select name="b">{{#CHOICE_B}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_B}}</select></label>
<button>Compare</button>
</form>
<section class="card moved {{MOVED_LEVEL}}" aria-label="What moved">
<p class="what" dir="auto">{{MOVED}}</p>
{{#MEASURED}}<p dir="auto">{{TEXT}}</p>{{/MEASURED}}
{{#LOOK}}<p class="soft">If somebody remounted it, all is well once it is calibrated anew. If nobody did, look whether its mount is loose or bent.</p>{{/LOOK}}
</section>
{{#SENSORS}}
<section class="card">
<h2 id="sensors">Sensors <span class="soft">as solved, against the reference; the farthest in &sigma; first</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="sensors">
<table class="moves" data-sortable data-filter="Filter sensors">
<thead><tr><th scope="col" data-column="0">Sensor</th><th scope="col" data-column="1">in &sigma;</th><th scope="col" data-column="2">moved, mm</th><th scope="col" class="sigma" data-column="3">&sigma;, mm</th><th scope="col" data-column="4">turned, mrad</th><th scope="col" data-column="5">turned, deg</th><th scope="col" class="sigma" data-column="6">&sigma;, deg</th><th scope="col" data-column="7">pixels at 10 m</th></tr></thead>
<tbody>
{{#MOVE}}<tr><th scope="row"><bdi>{{SENSOR}}</bdi></th><td><span class="badge {{LEVEL}}">{{IN_SIGMAS}}</span></td><td>{{MM}}</td><td class="sigma">{{SIGMA_MM}}</td><td>{{MRAD}}</td><td>{{DEG}}</td><td class="sigma">{{SIGMA_DEG}}</td><td>{{PIXELS}}</td></tr>
{{/MOVE}}
</tbody>
</table>
</div>
{{#MORE}}<p class="hint">{{COUNT}} more sensors moved less than these.</p>{{/MORE}}
<p class="hint">In &sigma;: the worst of the six axes; from 3 on the sensor moved. &sigma;: the larger one of both revisions, along the sensor's own axes. Pixels: how far the image of a point 10 m ahead of a camera moves, by turn and shift, at most.</p>
</section>
{{/SENSORS}}
{{#LENSES}}
<section class="card">
<h2 id="lenses">Lenses <span class="soft">where the same far point is projected, by the intrinsics of both revisions; the farthest off first</span></h2>
{{#EXPLAINED}}
<p class="hint lead">The turn of the camera that explains most of it is taken out: where a lens points is a matter of the camera's pose. A lens that nobody touched changes by what its map in the report leaves open. More than that: its focus was moved, or one of the two sessions has poor pictures. Compare what the two reports say of the camera.</p>
<div class="plots camera-plots certainty">
{{/EXPLAINED}}
{{#LENS}}
<figure class="plot tall">
<figcaption><strong>{{CAMERA}}</strong> {{SHIFT}}; a turn by {{TURN}} deg is taken out</figcaption>
{{>FIELD_MAP}}
</figure>
{{/LENS}}
{{#EXPLAINED}}</div>{{/EXPLAINED}}
{{#MORE_LENSES}}<p class="hint">{{COUNT}} more changed by less than these.</p>{{/MORE_LENSES}}
{{#SAME}}<p class="hint">The same intrinsics in both: <bdi>{{NAMES}}</bdi>.</p>{{/SAME}}
{{#NOT_COMPARED}}<p class="hint"><bdi>{{CAMERA}}</bdi> is not compared: {{WHY}}.</p>
{{/NOT_COMPARED}}
{{#MORE_NOT_COMPARED}}<p class="hint">{{COUNT}} more are not compared, either.</p>{{/MORE_NOT_COMPARED}}
</section>
{{/LENSES}}
<section class="card">
<h2 id="edges">Measurements <span class="soft">of each pair, the newest of both revisions; the farthest in &sigma; first</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="edges">
<table class="moves" data-sortable data-filter="Filter measurements">
<thead><tr><th scope="col" data-column="0">Pair</th><th scope="col" data-column="1">in &sigma;</th><th scope="col" data-column="2">moved, mm</th><th scope="col" class="sigma" data-column="3">&sigma;, mm</th><th scope="col" data-column="4">turned, mrad</th><th scope="col" class="sigma" data-column="5">&sigma;, mrad</th><th scope="col" class="text" data-column="6">Method</th></tr></thead>
<tbody>
{{#EDGE}}<tr><th scope="row">{{FROM}} &rarr; {{TO}}</th>{{#BOTH}}<td><span class="badge {{LEVEL}}">{{IN_SIGMAS}}</span></td>{{#TRANSLATION}}{{#KNOWN}}<td>{{MOVED}}</td><td class="sigma" data-v="{{SIGMA}}">{{SIGMA}}{{#PARTLY}}, free: {{NAMES}}{{/PARTLY}}</td>{{/KNOWN}}{{#FREE}}<td data-v="">free</td><td data-v=""></td>{{/FREE}}{{/TRANSLATION}}{{#ROTATION}}{{#KNOWN}}<td>{{MOVED}}</td><td class="sigma" data-v="{{SIGMA}}">{{SIGMA}}{{#PARTLY}}, free: {{NAMES}}{{/PARTLY}}</td>{{/KNOWN}}{{#FREE}}<td data-v="">free</td><td data-v=""></td>{{/FREE}}{{/ROTATION}}{{/BOTH}}{{#ALONE}}<td class="soft" data-v="">{{WHY}}</td><td></td><td></td><td></td><td></td>{{/ALONE}}<td class="text whole"><bdi>{{METHOD}}</bdi></td></tr>
{{/EDGE}}
</tbody>
</table>
</div>
{{#MORE_EDGES}}<p class="hint">{{COUNT}} more pairs are not shown: they are the least off.</p>{{/MORE_EDGES}}
<p class="hint">Each pair was measured by itself here: what the graph of all pairs makes of it stands above. &sigma;: of both measurements together, taken as independent. Free: one of them says nothing along or about this axis, so nothing is compared there.</p>
</section>
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
