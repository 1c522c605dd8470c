{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body class="certificate">
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../../../">Fleet</a> / <a href="../../">{{ROBOT}}</a> / <a href="index.html">revision {{NUMBER}}</a> / <span>certificate</span></nav>
<header>
<h1>{{KIND}} <span class="soft">{{ROBOT}}{{#RIG}}, rig <bdi>{{NAME}}</bdi>{{/RIG}}, revision {{NUMBER}}</span></h1>
<p class="meta">Measured {{CALIBRATED}}, solved {{TIME}}</p>
</header>
{{>BANNER}}
<section class="card">
<h2 id="sensors">Sensors <span class="soft">in the frame of {{REFERENCE}}</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="sensors">
<table>
<thead>
<tr><th rowspan="2" scope="col">Sensor</th><th colspan="3" scope="colgroup">Position, mm</th><th colspan="3" scope="colgroup">Rotation, deg</th><th colspan="2" scope="colgroup">&sigma;{{#LIMITS}} (limit){{/LIMITS}}</th><th rowspan="2" scope="col">k</th><th colspan="2" scope="colgroup">U = k &sigma;</th><th rowspan="2" scope="col">&sigma; within<br>limits</th></tr>
<tr><th scope="col">x</th><th scope="col">y</th><th scope="col">z</th><th scope="col">roll</th><th scope="col">pitch</th><th scope="col">yaw</th><th scope="col">mm</th><th scope="col">deg</th><th scope="col">mm</th><th scope="col">deg</th></tr>
</thead>
<tbody>
{{#SENSOR}}
<tr><th scope="row"><span class="name">{{NAME}}</span></th>{{#KNOWN}}<td>{{X}}</td><td>{{Y}}</td><td>{{Z}}</td><td>{{ROLL}}</td><td>{{PITCH}}</td><td>{{YAW}}</td>{{#CERTAINTY}}<td>{{SIGMA_MM}}{{#LIMIT_MM}} ({{VALUE}}){{/LIMIT_MM}}</td><td>{{SIGMA_DEG}}{{#LIMIT_DEG}} ({{VALUE}}){{/LIMIT_DEG}}</td><td>{{K}}</td><td>{{U_MM}}</td><td>{{U_DEG}}</td><td>{{WITHIN}}</td>{{/CERTAINTY}}{{#FIXED}}<td class="text" colspan="6">reference: fixed, without uncertainty</td>{{/FIXED}}{{/KNOWN}}{{#UNKNOWN}}<td class="text" colspan="12"><span class="badge unknown">unknown</span> {{WHY}}</td>{{/UNKNOWN}}</tr>
{{/SENSOR}}
</tbody>
</table>
</div>
{{#MORE_SENSORS}}<p class="hint">{{COUNT}} more, all more certain than these, are in the report.</p>{{/MORE_SENSORS}}
<p class="hint">Rotation R = Rz(yaw) Ry(pitch) Rx(roll). &sigma;: one standard deviation of the axis that is known worst. U holds the value with a probability of 95 %: k is Student's t by the degrees of freedom behind the sensor's covariance.{{#NO_K}} No k (&ndash;): these are not known.{{/NO_K}}</p>
</section>
<section class="card provenance">
<h2>Measured with</h2>
<dl>
{{#BOARDS}}<dt>Boards</dt><dd>{{#BOARD}}<div><bdi>{{NAME}}</bdi></div>{{/BOARD}}{{#MORE_BOARDS}}<div>and {{COUNT}} more</div>{{/MORE_BOARDS}}</dd>{{/BOARDS}}
<dt>Sessions</dt><dd>{{#SESSION}}<div>captured {{CAPTURED}}{{#OPERATOR}} by <bdi>{{NAME}}</bdi>{{/OPERATOR}} <code>{{SHORT}}</code></div>{{/SESSION}}{{#MORE_SESSIONS}}<div>and {{COUNT}}</div>{{/MORE_SESSIONS}}{{#EARLIER}}<div>and what sessions before these said of each pair</div>{{/EARLIER}}{{#PUSHED}}<div>{{COUNT}} pushed as finished results</div>{{/PUSHED}}{{#NOTHING}}<div>none that counts</div>{{/NOTHING}}</dd>
<dt>Software</dt><dd>rigcald <bdi>{{SOFTWARE}}</bdi></dd>
<dt>Document</dt><dd>revision.json <code>sha256 {{DIGEST}}</code></dd>
</dl>
</section>
{{#TO_SIGN}}<section class="signature" aria-label="Signature">
<p>Place and date</p><p>Name</p><p>Signature</p>
</section>{{/TO_SIGN}}
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
