{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
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
<div class="hero">
<section class="card" aria-label="Sensor graph">
<h2>Sensor graph</h2>
{{>GRAPH}}
<p class="legend">
<span class="key good">good edge</span>
<span class="key failed">failed edge</span>
<span class="key reference">reference</span>
<span class="key known">known</span>
<span class="key unknown">unknown</span>
</p>
<p class="hint">{{GRAPH_NOTE}}</p>
</section>
<section class="figures" aria-label="Key figures">
{{#FIGURE}}
<div class="card figure {{TONE}}">
<h3>{{NAME}}</h3>
<p class="value">{{VALUE}}</p>
{{#DETAIL}}<p class="hint">{{TEXT}}</p>{{/DETAIL}}
</div>
{{/FIGURE}}
</section>
</div>
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
<table>
<thead>
<tr><th rowspan="2" scope="col">Edge</th><th rowspan="2" scope="col" class="text">State</th><th rowspan="2" scope="col" class="text">Method</th><th rowspan="2" scope="col">Captures</th><th colspan="2" scope="colgroup">Size</th><th colspan="3" scope="colgroup">Residual</th><th colspan="2" scope="colgroup" class="sigma">Largest &sigma;</th></tr>
<tr><th scope="col">mm</th><th scope="col">deg</th><th scope="col">mm</th><th scope="col">deg</th><th scope="col">in &sigma;</th><th scope="col" class="sigma">mm</th><th scope="col" class="sigma">deg</th></tr>
</thead>
<tbody>
{{#EDGE}}
<tr><th scope="row">{{#LINK}}<a href="#{{ANCHOR}}">{{FROM}} &rarr; {{TO}}</a>{{/LINK}}{{#PLAIN}}{{FROM}} &rarr; {{TO}}{{/PLAIN}}</th><td class="text"><span class="badge {{LEVEL}}">{{STATE}}</span></td><td class="text"><bdi>{{METHOD}}</bdi></td><td>{{CAPTURES}}</td>{{#GOOD}}<td>{{T_MM}}</td><td>{{T_DEG}}</td>{{#FIT}}<td>{{E_MM}}</td><td>{{E_DEG}}</td><td>{{E_SIGMA}}</td>{{/FIT}}{{#NO_FIT}}<td class="text" colspan="3">not in the solution</td>{{/NO_FIT}}<td class="sigma">{{S_MM}}</td><td class="sigma">{{S_DEG}}</td>{{/GOOD}}{{#FAILED}}<td class="text" colspan="7" dir="auto">{{WHY}}</td>{{/FAILED}}</tr>
{{/EDGE}}
</tbody>
</table>
</div>
{{#MORE_EDGES}}<p class="hint">{{COUNT}} more edges, all of them better than these, are in <a href="revision.json">revision.json</a>.</p>{{/MORE_EDGES}}
<p class="hint">{{EDGES_NOTE}}</p>
</section>
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
<dt>Sessions</dt><dd>{{#SESSION}}<code>{{ID}}</code> <span class="soft">{{EDGES}}</span><br>{{/SESSION}}{{#PUSHED}}{{COUNT}} pushed as finished results{{/PUSHED}}{{#MORE_SESSIONS}}and {{COUNT}} more sessions{{/MORE_SESSIONS}}</dd>
</dl>
</section>
</main>
</body>
</html>
