{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<a class="skip" href="#edges">To the edges</a>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../../../">Fleet</a> / <a href="../../">{{ROBOT}}</a> / <span>revision {{NUMBER}}</span></nav>
<header>
<h1>{{ROBOT}} <span class="soft">revision {{NUMBER}}</span></h1>
<p class="meta">Calibrated {{TIME}}</p>
</header>
{{>BANNER}}
{{#NOTES}}
<ul class="notes">
{{#NOTE}}<li dir="auto">{{WHAT}} <span class="cure">{{CURE}}</span></li>
{{/NOTE}}
</ul>
{{/NOTES}}
<section class="figures" aria-label="Key figures">
{{#FIGURE}}
<div class="card figure {{TONE}}">
<h2>{{NAME}}</h2>
<p class="value">{{VALUE}}</p>
{{#DETAIL}}<p class="hint">{{TEXT}}</p>{{/DETAIL}}
</div>
{{/FIGURE}}
</section>
{{#CHANGES}}
<section class="card changes" aria-labelledby="changes">
<h2 id="changes">What changed since <a href="../{{PREVIOUS}}/">revision {{PREVIOUS}}</a></h2>
<ul>
{{#LINE}}<li dir="auto">{{TEXT}}</li>
{{/LINE}}
</ul>
{{#MOVES}}
<div class="scroll" tabindex="0" role="region" aria-label="How far sensors moved">
<table class="small">
<thead><tr><th scope="col">Sensor</th><th scope="col">moved, mm</th><th scope="col">&sigma;, mm</th><th scope="col">turned, deg</th><th scope="col">&sigma;, deg</th><th scope="col">in &sigma;</th></tr></thead>
<tbody>
{{#MOVE}}<tr><th scope="row"><bdi>{{SENSOR}}</bdi></th><td>{{MM}}</td><td class="sigma">{{SIGMA_MM}}</td><td>{{DEG}}</td><td class="sigma">{{SIGMA_DEG}}</td><td><span class="badge {{LEVEL}}">{{IN_SIGMAS}}</span></td></tr>
{{/MOVE}}
</tbody>
</table>
</div>
{{/MOVES}}
</section>
{{/CHANGES}}
{{#FIRST}}<p class="hint first">The first revision of this robot: there is nothing to compare it with.</p>{{/FIRST}}
<section class="card" id="rig" aria-label="The rig in 3D" hidden>
<h2>The rig <span class="soft">select a sensor for its numbers</span></h2>
<div class="rig">
<div class="view"></div>
<div class="panel" aria-live="polite"></div>
</div>
<div class="bar"></div>
</section>
<section class="card" aria-label="Sensor graph">
<h2>Sensor graph</h2>
{{>GRAPH}}
<p class="legend">
<span class="key fit0">below 1 &sigma;</span>
<span class="key fit1">1 to 2 &sigma;</span>
<span class="key fit2">2 to 3 &sigma;</span>
<span class="key fit3">beyond 3 &sigma;</span>
<span class="key unchecked">not checked by a loop</span>
<span class="key failed">failed edge</span>
<span class="key reference">reference</span>
<span class="key known">known</span>
<span class="key unknown">unknown</span>
</p>
<p class="hint">Colour: residual of the edge in its &sigma;. Width: how certain its position is. {{GRAPH_NOTE}}</p>
</section>
<section class="card">
<h2 id="poses">Sensors <span class="soft">in the frame of {{REFERENCE}}</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="poses">
<table>
<thead>
<tr><th rowspan="2" scope="col">Sensor</th><th colspan="3" scope="colgroup">Position, mm</th><th colspan="3" scope="colgroup">Rotation, deg</th><th colspan="3" scope="colgroup" class="sigma">&sigma;, mm</th><th colspan="3" scope="colgroup" class="sigma">&sigma;, deg</th></tr>
<tr><th scope="col">x</th><th scope="col">y</th><th scope="col">z</th><th scope="col">roll</th><th scope="col">pitch</th><th scope="col">yaw</th><th scope="col" class="sigma">x</th><th scope="col" class="sigma">y</th><th scope="col" class="sigma">z</th><th scope="col" class="sigma">rx</th><th scope="col" class="sigma">ry</th><th scope="col" class="sigma">rz</th></tr>
</thead>
<tbody>
{{#POSE}}
<tr><th scope="row">{{SENSOR}}</th>{{#KNOWN}}<td>{{X}}</td><td>{{Y}}</td><td>{{Z}}</td><td>{{ROLL}}</td><td>{{PITCH}}</td><td>{{YAW}}</td>{{#SIGMA}}<td class="sigma">{{VALUE}}</td>{{/SIGMA}}{{#FIXED}}<td class="sigma text" colspan="6">reference: fixed, without uncertainty</td>{{/FIXED}}{{/KNOWN}}{{#UNKNOWN}}<td class="text" colspan="12"><span class="badge unknown">unknown</span> {{WHY}}</td>{{/UNKNOWN}}</tr>
{{/POSE}}
</tbody>
</table>
</div>
{{#MORE_POSES}}<p class="hint">{{COUNT}} more sensors are in <a href="revision.json">revision.json</a>.</p>{{/MORE_POSES}}
<p class="hint">Rotation R = Rz(yaw) Ry(pitch) Rx(roll). &sigma; is one standard deviation along the sensor's own axes.</p>
</section>
{{#CLOUDS_SECTION}}
{{>CLOUDS}}
{{/CLOUDS_SECTION}}
<section class="card">
<h2 id="edges">Edges <span class="soft">failed first, then the worst fit</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="edges">
<table class="edges" data-sortable data-filter="Filter edges">
<thead>
<tr><th scope="col" data-column="0">Edge</th><th scope="col" class="text" data-column="1">State</th><th scope="col" class="text" data-column="2">Method</th><th scope="col" data-column="3">Captures</th><th scope="col" data-column="4">Residual<br>x / y / z, mm</th><th scope="col" data-column="5">rx / ry / rz,<br>deg</th><th scope="col" data-column="6">in &sigma;</th><th scope="col" data-column="7">T&sup2;<br>(limit)</th><th scope="col" data-column="8">Without the edge<br>mm / deg / &sigma;</th><th scope="col" class="sigma" data-column="9">&sigma;<br>x / y / z, mm</th><th scope="col" class="sigma" data-column="10">&sigma; rx / ry / rz,<br>deg</th><th scope="col" class="text" data-column="11">&sigma; from</th><th scope="col" data-column="12">Capture that<br>counts, mm</th></tr>
</thead>
<tbody>
{{#EDGE}}
<tr><th scope="row">{{#LINK}}<a href="#{{ANCHOR}}">{{FROM}} &rarr; {{TO}}</a>{{/LINK}}{{#PLAIN}}{{FROM}} &rarr; {{TO}}{{/PLAIN}}</th><td class="text"><span class="badge {{LEVEL}}">{{STATE}}</span>{{#SUSPECT}} <span class="badge fail">contradicts</span>{{/SUSPECT}}{{#ALTERNATIVE}} <span class="badge warn">doubtful</span>{{/ALTERNATIVE}}</td><td class="text"><bdi>{{METHOD}}</bdi></td><td data-v="{{CAPTURES_KEY}}">{{CAPTURES}}</td>{{#GOOD}}{{#FIT}}<td data-v="{{E_MM_KEY}}">{{E_MM}}</td><td data-v="{{E_DEG_KEY}}">{{E_DEG}}</td><td>{{E_SIGMA}}</td>{{/FIT}}{{#NO_FIT}}<td data-v="" class="soft">not solved</td><td data-v=""></td><td data-v=""></td>{{/NO_FIT}}{{#TEST}}<td data-v="{{T2}}"><span{{#BEYOND}} class="beyond"{{/BEYOND}}>{{T2}} ({{LIMIT}})</span></td>{{/TEST}}{{#NO_TEST}}<td data-v="" class="soft">no test</td>{{/NO_TEST}}{{#WITHOUT}}<td data-v="{{SIGMAS}}">{{MM}} / {{DEG}} / {{SIGMAS}}<br><span class="soft">{{SENSOR}}</span></td>{{/WITHOUT}}{{#NO_WITHOUT}}<td data-v="" class="soft">{{WHY}}</td>{{/NO_WITHOUT}}<td class="sigma" data-v="{{S_MM_KEY}}">{{S_MM}}</td><td class="sigma" data-v="{{S_DEG_KEY}}">{{S_DEG}}</td><td class="text">{{SOURCE}}</td>{{#INFLUENCE}}<td data-v="{{MM}}">{{MM}} <span class="soft">{{CAPTURE}}</span></td>{{/INFLUENCE}}{{#NO_INFLUENCE}}<td data-v=""></td>{{/NO_INFLUENCE}}{{/GOOD}}{{#FAILED}}<td class="text" colspan="9" dir="auto">{{WHY}}</td>{{/FAILED}}</tr>
{{/EDGE}}
</tbody>
</table>
</div>
{{#MORE_EDGES}}<p class="hint">{{COUNT}} more edges, all of them better than these, are in <a href="edges.csv">edges.csv</a>.</p>{{/MORE_EDGES}}
{{#UNCHECKED}}<p class="hint">{{TEXT}}</p>{{/UNCHECKED}}
{{#NO_EDGE_INFLUENCE}}<p class="hint">{{TEXT}}</p>{{/NO_EDGE_INFLUENCE}}
<p class="hint">&sigma;: one standard deviation along and about the axes of the second sensor. In &sigma;: root mean square of the residual over the directions that are checked. T&sup2;: the residual by its own covariance; beyond the limit the edge contradicts the others. Without the edge: how far the pose of the sensor named, the most moved of all, changes when the edge is left out, in its &sigma; too. Capture that counts: how far the position of this edge moves without the capture named, the one that matters most. <a href="edges.csv" download>All edges as CSV</a></p>
</section>
{{#LOOPS_SECTION}}
{{>LOOPS}}
{{/LOOPS_SECTION}}
{{#CAMERAS_SECTION}}
{{>CAMERAS}}
{{/CAMERAS_SECTION}}
{{#DETAIL_SECTION}}
{{>DETAIL}}
{{/DETAIL_SECTION}}
{{#MORE_DETAILS}}<p class="hint">Details of {{COUNT}} more edges are in <a href="revision.json">revision.json</a>.</p>{{/MORE_DETAILS}}
<section class="card provenance">
<h2>Where this comes from</h2>
<dl>
<dt>Robot</dt><dd>{{ROBOT}}</dd>
<dt>Revision</dt><dd>{{NUMBER}}</dd>
<dt>Solved at</dt><dd>{{TIME}}</dd>
<dt>Software</dt><dd>rigcald <bdi>{{SOFTWARE}}</bdi></dd>
<dt>Document</dt><dd><a href="revision.json">revision.json</a> <code>sha256 {{DIGEST}}</code></dd>
<dt>Sessions</dt><dd>{{#SESSION}}<a href="../../sessions/{{ID}}/"><code>{{ID}}</code></a> <span class="soft">{{EDGES}}</span>{{#FACTS}}<br>captured {{CAPTURED}}{{#OPERATOR}} by <bdi>{{NAME}}</bdi>{{/OPERATOR}}{{#RIG}}, rig <bdi>{{NAME}}</bdi>{{/RIG}}, {{FILES}}{{#BOARD}}; <bdi>{{NAME}}</bdi>{{/BOARD}}{{/FACTS}}<br>{{/SESSION}}{{#PUSHED}}{{COUNT}} pushed as finished results{{/PUSHED}}{{#MORE_SESSIONS}}and {{COUNT}} more sessions{{/MORE_SESSIONS}}</dd>
</dl>
<p class="downloads"><a href="revision.json" download>revision.json</a> <a href="edges.csv" download>edges.csv</a></p>
</section>
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
