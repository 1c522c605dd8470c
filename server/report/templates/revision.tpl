{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<a class="skip" href="#edges">To the edges</a>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../../../">Fleet</a> / <a href="../../">{{ROBOT}}</a> / <span>revision {{NUMBER}}</span></nav>
<header>
<h1>{{ROBOT}} <span class="soft">revision {{NUMBER}}</span></h1>
<p class="meta">{{#CAPTURED}}Captured {{DAY}}{{#OPERATOR}} by <bdi>{{NAME}}</bdi>{{/OPERATOR}}{{#RIG}}, rig <bdi>{{NAME}}</bdi>{{/RIG}}{{#BEFORE}}, and {{SESSIONS}}{{/BEFORE}}; solved {{/CAPTURED}}{{#NO_CAPTURED}}Solved {{/NO_CAPTURED}}{{TIME}} <a class="screen" href="certificate.html">{{SHEET}} to print</a></p>
</header>
{{>BANNER}}
{{>FIGURES}}
{{#CAUSES_SECTION}}
{{>CAUSES}}
{{/CAUSES_SECTION}}
{{#NOTES}}
<ul class="notes">
{{#NOTE}}<li dir="auto">{{WHAT:x-typed}} <span class="cure">{{CURE:x-typed}}</span></li>
{{/NOTE}}
</ul>
{{/NOTES}}
{{#CHANGES}}
<section class="card changes" aria-labelledby="changes">
<h2 id="changes">What changed since <a href="../{{PREVIOUS}}/">revision {{PREVIOUS}}</a></h2>
<ul>
{{#LINE}}<li dir="auto">{{TEXT}}</li>
{{/LINE}}
</ul>
{{#MOVES}}
<div class="scroll" tabindex="0" role="region" aria-label="By how much poses changed">
<table class="small">
<thead><tr><th scope="col">Sensor</th><th scope="col">changed by, mm</th><th scope="col">&sigma;, mm</th><th scope="col">and by, deg</th><th scope="col">&sigma;, deg</th><th scope="col">in &sigma;</th></tr></thead>
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
{{#AS_FOUND_SECTION}}
{{>AS_FOUND}}
{{/AS_FOUND_SECTION}}
<section class="card" id="rig" data-part="Rig in 3D" aria-label="The rig in 3D" hidden>
<h2>The rig <span class="soft">select a sensor for its numbers</span></h2>
<div class="rig">
<div class="view"></div>
<div class="panel" aria-live="polite"></div>
</div>
<div class="bar"></div>
</section>
<section class="card" aria-labelledby="graph">
<h2 id="graph" data-part="Graph">Sensor graph</h2>
{{>GRAPH}}
<p class="legend">
<span class="key fit0">below 1 &sigma;</span>
<span class="key fit1">1 to 2 &sigma;</span>
<span class="key fit2">2 to 3 &sigma;</span>
<span class="key fit3">beyond 3 &sigma;</span>
<span class="key unchecked">not checked, or only in part</span>
<span class="key failed">failed edge</span>
<span class="key reference">reference</span>
<span class="key known">known</span>
<span class="key unknown">unknown</span>
</p>
<p class="hint">Colour: how far the edge is from the solution, in its &sigma;. Width: the wider, the more certain its position. {{GRAPH_NOTE}}</p>
</section>
{{>WHOLE_FIGURES}}
<section class="card">
<h2 id="poses" data-part="Sensors">Sensors <span class="soft">in the frame of {{REFERENCE}}</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="poses">
<table>
<thead>
<tr><th rowspan="2" scope="col">Sensor</th><th colspan="3" scope="colgroup">Position, mm</th><th colspan="3" scope="colgroup">Rotation, deg</th><th colspan="3" scope="colgroup" class="sigma">&sigma;, mm</th><th colspan="3" scope="colgroup" class="sigma">&sigma;, deg</th><th rowspan="2" scope="col" class="text">Limit of &sigma;</th></tr>
<tr><th scope="col">x</th><th scope="col">y</th><th scope="col">z</th><th scope="col">roll</th><th scope="col">pitch</th><th scope="col">yaw</th><th scope="col" class="sigma">x</th><th scope="col" class="sigma">y</th><th scope="col" class="sigma">z</th><th scope="col" class="sigma">rx</th><th scope="col" class="sigma">ry</th><th scope="col" class="sigma">rz</th></tr>
</thead>
<tbody>
{{#POSE}}
<tr{{#CULPRIT}} class="culprit"{{/CULPRIT}}><th scope="row">{{SENSOR}}</th>{{#KNOWN}}<td>{{X}}</td><td>{{Y}}</td><td>{{Z}}</td><td>{{ROLL}}</td><td>{{PITCH}}</td><td>{{YAW}}</td>{{#SIGMA}}<td class="sigma">{{VALUE}}</td>{{/SIGMA}}{{#FIXED}}<td class="sigma text" colspan="6">reference: fixed, without uncertainty</td>{{/FIXED}}<td class="text limit">{{LIMIT}}</td>{{/KNOWN}}{{#PART}}<td class="text" colspan="3">{{#AT}}<div>{{LABEL}} {{VALUE}}</div>{{/AT}}</td>{{#TURNED}}<td>{{ROLL}}</td><td>{{PITCH}}</td><td>{{YAW}}</td>{{/TURNED}}{{#TURN_OPEN}}<td class="text" colspan="3">{{#OF}}<div>{{LABEL}} {{VALUE}}</div>{{/OF}}</td>{{/TURN_OPEN}}<td class="sigma text" colspan="3">{{#SIGMA_MM}}<div>{{LABEL}} {{VALUE}}</div>{{/SIGMA_MM}}</td><td class="sigma text" colspan="3">{{#SIGMA_DEG}}<div>{{LABEL}} {{VALUE}}</div>{{/SIGMA_DEG}}</td><td class="text limit">{{LIMIT}}</td>{{/PART}}{{#UNKNOWN}}<td class="text" colspan="13"><span class="badge unknown">unknown</span> {{WHY}}</td>{{/UNKNOWN}}</tr>
{{/POSE}}
</tbody>
</table>
</div>
{{#IN_PART}}<p class="hint">Of a sensor of which not everything was measured, position and &sigma; are along and about the axes of <bdi>{{WHOSE}}</bdi>, as near to these as what was measured lies.</p>{{/IN_PART}}
{{#MORE_POSES}}<p class="hint">{{COUNT}} more sensors are in <a href="revision.json">revision.json</a>.</p>{{/MORE_POSES}}
{{#GONE}}<p dir="auto"><span class="badge unknown">past</span> {{WHY}}. To bring it back: <code class="typed">{{COMMAND}}</code></p>
{{/GONE}}
<p class="hint">Rotation R = Rz(yaw) Ry(pitch) Rx(roll). &sigma; is one standard deviation along the sensor's own axes.</p>
{{#WAYS_OUT}}
<details class="words">
<summary>If a sensor is gone from the robot</summary>
<ul>
{{#RETIRE}}<li><code class="typed">{{COMMAND}}</code></li>
{{/RETIRE}}
</ul>
</details>
{{/WAYS_OUT}}
</section>
{{#FUSED_SECTION}}
{{>FUSED}}
{{/FUSED_SECTION}}
{{#CLOUDS_SECTION}}
{{>CLOUDS}}
{{/CLOUDS_SECTION}}
<section class="card">
<h2 id="edges" data-part="Edges">Edges <span class="soft">failed first, then the worst fit</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="edges">
<table class="edges" data-sortable data-filter="Filter edges">
<thead>
<tr><th scope="col" data-column="0">Edge</th><th scope="col" class="text" data-column="1">State</th><th scope="col" class="text" data-column="2">Method</th><th scope="col" data-column="3">Captures</th><th scope="col" data-column="4">Residual, mm: x / y / z<br>deg: rx / ry / rz</th><th scope="col" data-column="5">Residual<br>in &sigma;</th><th scope="col" data-column="6">T&sup2;<br>(limit)</th><th scope="col" class="sigma" data-column="7">&sigma;, mm: x / y / z<br>deg: rx / ry / rz</th><th scope="col" data-column="8">Without the edge<br>mm / deg / &sigma;</th><th scope="col" data-column="9">Capture that<br>counts, mm</th></tr>
</thead>
<tbody>
{{#EDGE_GROUP}}
<tr><th scope="row">{{#LINK}}<a href="#{{ANCHOR}}">{{COUNT}}</a>{{/LINK}}{{#PLAIN}}{{COUNT}}{{/PLAIN}}</th><td class="text"><span class="badge fail">failed</span></td><td class="text" colspan="8" data-v=""><span dir="auto">{{WHY:x-typed}}</span><details class="words"><summary>Which pairs</summary>{{>PAIRS}}</details></td></tr>
{{/EDGE_GROUP}}
{{#EDGE}}
<tr><th scope="row">{{#LINK}}<a href="#{{ANCHOR}}">{{FROM}} &rarr; {{TO}}</a>{{/LINK}}{{#EARLIER}}<a href="../{{REVISION}}/#{{ANCHOR}}">{{FROM}} &rarr; {{TO}}</a> <span class="soft">rev. {{REVISION}}</span>{{/EARLIER}}{{#PLAIN}}{{FROM}} &rarr; {{TO}}{{/PLAIN}}{{#RETIRE}}<details class="words"><summary>If it is wrong</summary><code class="typed">{{COMMAND}}</code></details>{{/RETIRE}}</th><td class="text"><span class="badge {{LEVEL}}">{{STATE}}</span></td><td class="text"><bdi>{{METHOD}}</bdi></td><td data-v="{{CAPTURES_KEY}}">{{CAPTURES}}</td>{{#GOOD}}{{#FIT}}<td data-v="{{E_MM_KEY}}">{{E_MM}}<br>{{E_DEG}}{{#IN_PART}}<span class="soft in-part">{{WHAT}}</span>{{/IN_PART}}</td><td><span class="badge {{CLASS}}">{{E_SIGMA}}</span></td>{{/FIT}}{{#NO_FIT}}<td data-v="" class="soft">{{WHY}}</td><td data-v=""></td>{{/NO_FIT}}{{#TEST}}<td data-v="{{T2}}"><span{{#BEYOND}} class="beyond"{{/BEYOND}}>{{T2}} ({{LIMIT}})</span></td>{{/TEST}}{{#NO_TEST}}<td data-v="" class="soft">no test</td>{{/NO_TEST}}<td class="sigma" data-v="{{S_MM_KEY}}">{{S_MM}}<br>{{S_DEG}}{{#SOURCE}}<br>{{TEXT}}{{/SOURCE}}</td>{{#WITHOUT}}<td data-v="{{SIGMAS}}">{{MM}} / {{DEG}} / {{SIGMAS}}<br><span class="soft">{{SENSOR}}</span></td>{{/WITHOUT}}{{#NO_WITHOUT}}<td data-v="" class="soft">{{WHY}}</td>{{/NO_WITHOUT}}{{#INFLUENCE}}<td data-v="{{MM}}">{{MM}}<br><span class="soft">{{CAPTURE}}</span></td>{{/INFLUENCE}}{{#NO_INFLUENCE}}<td data-v=""></td>{{/NO_INFLUENCE}}{{/GOOD}}{{#FAILED}}<td class="text" colspan="6" data-v="" dir="auto">{{WHY}}{{#CURE}} <span class="cure">{{TEXT:x-typed}}</span>{{/CURE}}</td>{{/FAILED}}</tr>
{{/EDGE}}
</tbody>
</table>
</div>
{{#MORE_EDGES}}<p class="hint">{{COUNT}} more edges, all of them better than these, are in <a href="edges.csv">edges.csv</a>.</p>{{/MORE_EDGES}}
{{#OTHER_IDS}}<p class="hint">Ids of all edges, as <code>rigcal retire</code> takes them: <code>rigcal edges {{ROBOT}}</code></p>{{/OTHER_IDS}}
{{#UNCHECKED}}<p class="hint">{{TEXT}}</p>{{/UNCHECKED}}
{{#NO_EDGE_INFLUENCE}}<p class="hint">{{TEXT}}</p>{{/NO_EDGE_INFLUENCE}}
<p class="downloads"><a class="button" href="edges.csv" download>All edges as CSV</a></p>
<details class="words">
<summary>What the columns mean</summary>
<dl class="pairs">
<dt>Residual</dt><dd>How far the measured edge is from the solved rig, along and about the axes of the second sensor. In &sigma;: its root mean square over the directions that are checked; up to about 2 is usual.</dd>
<dt>T&sup2; (limit)</dt><dd>The residual by its own covariance. Beyond the limit the edge contradicts the others.</dd>
<dt>&sigma;</dt><dd>One standard deviation of the edge itself, along and about the axes of the second sensor; from leaving out one capture at a time, unless something else is said.</dd>
<dt>Without the edge</dt><dd>How far the pose of the sensor named, the most moved of all, changes when the edge is left out; in its &sigma;, too.</dd>
<dt>Capture that counts</dt><dd>How far the position of the edge moves without the capture named, the one that matters most.</dd>
</dl>
</details>
</section>
{{#LOOPS_SECTION}}
{{>LOOPS}}
{{/LOOPS_SECTION}}
{{#CAMERAS_SECTION}}
{{>CAMERAS}}
{{/CAMERAS_SECTION}}
{{#DETAILS}}<h2 class="part" id="details" data-part="Each edge">Each edge <span class="soft">open one to see what stands behind it</span>{{#WARNED}} <span class="badge warn">{{TEXT}}</span>{{/WARNED}}</h2>
<p class="paper">What failed or has a warning is printed, and what was open on the screen.</p>
{{/DETAILS}}
{{#DETAIL_GROUP}}
<details class="card edge failed group">
<summary><span class="badge fail">{{COUNT}}</span> <h2 dir="auto">{{WHY:x-typed}}</h2></summary>
<div id="{{ANCHOR}}" class="body">
<p class="cure" dir="auto">{{WHAT_TO_DO:x-typed}}</p>
{{#GROUPED}}
{{>DETAIL}}
{{/GROUPED}}
</div>
</details>
{{/DETAIL_GROUP}}
{{#DETAIL_SECTION}}
{{>DETAIL}}
{{/DETAIL_SECTION}}
{{#EARLIER_DETAILS}}<p class="hint">{{TEXT}}</p>{{/EARLIER_DETAILS}}
{{#MORE_DETAILS}}<p class="hint">Details of {{COUNT}} more edges: <code>rigcal show {{ROBOT}} --revision {{NUMBER}} --whole --json</code> has them.</p>{{/MORE_DETAILS}}
<section class="card provenance">
<h2 id="source" data-part="Source">Where this comes from</h2>
<dl>
<dt>Robot</dt><dd>{{ROBOT}}</dd>
<dt>Revision</dt><dd>{{NUMBER}}</dd>
<dt>Solved</dt><dd>{{TIME}}</dd>
<dt>Software</dt><dd>rigcald <bdi>{{SOFTWARE}}</bdi></dd>
<dt>Document</dt><dd><a href="revision.json">revision.json</a> <code>sha256 {{DIGEST}}</code></dd>
<dt>Sessions</dt><dd>{{#SESSION}}<div class="session"><a href="../../sessions/{{ID}}/">{{#FACTS}}Captured {{CAPTURED}}{{/FACTS}}{{#NO_FACTS}}Session{{/NO_FACTS}}</a>{{#FACTS}}{{#OPERATOR}} by <bdi>{{NAME}}</bdi>{{/OPERATOR}}{{#RIG}}, rig <bdi>{{NAME}}</bdi>{{/RIG}}, {{FILES}}{{/FACTS}}, {{EDGES}}<br><code>{{ID}}</code>{{#FACTS}}{{#BOARDS}}<ul>{{#BOARD}}<li><bdi>{{NAME}}</bdi></li>{{/BOARD}}</ul>{{/BOARDS}}{{#BOARD_REMARK}}<p dir="auto"><span class="badge {{LEVEL}}">{{WORD}}</span> {{WHY}}. {{CURE:x-typed}}</p>{{/BOARD_REMARK}}{{/FACTS}}</div>{{/SESSION}}{{#EARLIER}}<div class="session">and, of each pair, up to {{COUNT}} before these: what they said is one edge</div>{{/EARLIER}}{{#PUSHED}}{{COUNT}} pushed as finished results{{/PUSHED}}{{#MORE_SESSIONS}}and {{COUNT}} more sessions{{/MORE_SESSIONS}}</dd>
</dl>
<p class="downloads"><a class="button" href="revision.json" download>Result as JSON</a> <a class="button" href="edges.csv" download>Edges as CSV</a> <a class="button" href="certificate.html">{{SHEET}} to print</a></p>
<p class="hint">The whole report as one file: <code>rigcal report {{ROBOT}} --out report.zip</code></p>
</section>
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
{{#LATER}}<script defer src="{{PATH}}" data-scripts="{{SCRIPTS}}"></script>
{{/LATER}}
</body>
</html>
