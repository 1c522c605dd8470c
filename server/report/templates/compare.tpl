{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../">Fleet</a> / <a href="./">{{ROBOT}}</a> / <span>compare</span></nav>
<header>
<h1>{{ROBOT}} <span class="soft">revision {{BEFORE}} and {{NOW}}</span></h1>
<p class="meta"><a href="revisions/{{BEFORE}}/">Revision {{BEFORE}}</a>: {{VERDICT_BEFORE}}. <a href="revisions/{{NOW}}/">Revision {{NOW}}</a>: {{VERDICT_NOW}}.</p>
</header>
<form class="search" action="compare" method="get">
<label>Revision <select name="a">{{#CHOICE_A}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_A}}</select></label>
<label>with <select name="b">{{#CHOICE_B}}<option{{#CHOSEN}} selected{{/CHOSEN}}>{{NUMBER}}</option>{{/CHOICE_B}}</select></label>
<button>Compare</button>
</form>
<section class="card">
<h2 id="sensors">Sensors <span class="soft">the farthest in &sigma; first</span></h2>
{{#OTHER_REFERENCE}}<p>The two revisions have different reference sensors: poses are not compared.</p>{{/OTHER_REFERENCE}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="sensors">
<table data-sortable data-filter="Filter sensors">
<thead><tr><th scope="col" data-column="0">Sensor</th><th scope="col" data-column="1">moved, mm</th><th scope="col" class="sigma" data-column="2">&sigma;, mm</th><th scope="col" data-column="3">turned, mrad</th><th scope="col" data-column="4">turned, deg</th><th scope="col" class="sigma" data-column="5">&sigma;, deg</th><th scope="col" data-column="6">in &sigma;</th><th scope="col" data-column="7">pixels at 10 m</th></tr></thead>
<tbody>
{{#MOVE}}<tr><th scope="row"><bdi>{{SENSOR}}</bdi></th><td>{{MM}}</td><td class="sigma">{{SIGMA_MM}}</td><td>{{MRAD}}</td><td>{{DEG}}</td><td class="sigma">{{SIGMA_DEG}}</td><td><span class="badge {{LEVEL}}">{{IN_SIGMAS}}</span></td><td>{{PIXELS}}</td></tr>
{{/MOVE}}
</tbody>
</table>
</div>
<p class="hint">&sigma;: the larger one of both revisions, along the sensor's own axes. In &sigma;: the worst of the six axes. Pixels: how far the image of a point 10 m ahead of a camera moves, by turn and shift, at most.</p>
</section>
<section class="card">
<h2 id="edges">Edges <span class="soft">of both revisions</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="edges">
<table data-sortable data-filter="Filter edges">
<thead><tr><th scope="col" data-column="0">Edge</th><th scope="col" class="text" data-column="1">Method</th><th scope="col" data-column="2">moved, mm</th><th scope="col" data-column="3">turned, mrad</th><th scope="col" class="sigma" data-column="4">&sigma; before, mm</th><th scope="col" class="sigma" data-column="5">&sigma; after, mm</th></tr></thead>
<tbody>
{{#EDGE}}<tr><th scope="row">{{FROM}} &rarr; {{TO}}</th><td class="text"><bdi>{{METHOD}}</bdi></td>{{#BOTH}}<td>{{MM}}</td><td>{{MRAD}}</td><td class="sigma">{{SIGMA_BEFORE}}</td>{{/BOTH}}{{#NEW}}<td data-v="">new</td><td data-v=""></td><td data-v=""></td>{{/NEW}}<td class="sigma">{{SIGMA_NOW}}</td></tr>
{{/EDGE}}
</tbody>
</table>
</div>
</section>
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
