{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../">Fleet</a> / <a href="../">rig models</a> / <span dir="auto">{{NAME}}</span></nav>
<header>
<h1 dir="auto">{{NAME}}</h1>
<p class="meta">{{SUMMARY}}</p>
</header>
{{#WHY_NOT}}<p class="working" role="status" dir="auto">{{TEXT}}</p>{{/WHY_NOT}}
{{#OFF}}<p class="working" dir="auto">{{TEXT}} Check the nominal (CAD) poses before the mounts.</p>
{{/OFF}}
{{#OUTLIERS}}
<section class="card">
<h2 id="outliers">Robots that stand out <span class="soft">by more than chance</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="outliers">
<table class="list">
<thead><tr><th scope="col">Robot</th><th scope="col">Sensor</th><th scope="col">From where the others have it</th><th scope="col">Most along</th></tr></thead>
<tbody>
{{#OUTLIER}}<tr><th scope="row"><a href="../../robots/{{ROBOT}}/">{{ROBOT}}</a></th><td class="text"><bdi>{{SENSOR}}</bdi></td><td class="text">{{MM}} mm, {{DEG}} deg</td><td class="text">{{AXIS}}</td></tr>
{{/OUTLIER}}
</tbody>
</table>
</div>
{{#MORE}}<p class="hint">{{TEXT}}</p>{{/MORE}}
</section>
{{/OUTLIERS}}
{{#SENSOR}}
<section class="card" aria-label="{{NAME}}">
<h2 dir="auto">{{NAME}} <span class="soft">on {{ROBOTS}}</span></h2>
{{#DRAWN}}<p class="hint">Zero is the nominal (CAD) pose; the outer marks are its tolerance, {{LIMIT}}. Axes are the sensor's own.</p>{{/DRAWN}}
{{#NOT_DRAWN}}<p class="hint">Zero is the median of all robots, as the rig model has no place of it. Axes are the sensor's own.</p>{{/NOT_DRAWN}}
{{>SPREAD}}
<details class="words"><summary>Numbers</summary>
<div class="scroll" tabindex="0" role="region" aria-label="Numbers of {{NAME}}">
<table class="list">
<thead><tr><th scope="col">Axis</th><th scope="col" class="num">Median</th><th scope="col" class="num">Spread, 1 &sigma;</th><th scope="col" class="num">Least</th><th scope="col" class="num">Most</th></tr></thead>
<tbody>
{{#AXIS}}<tr><th scope="row">{{NAME}} <span class="soft">{{UNIT}}</span></th><td>{{MEDIAN}}</td><td>{{SPREAD}}</td><td>{{MIN}}</td><td>{{MAX}}</td></tr>
{{/AXIS}}
</tbody>
</table>
</div>
</details>
</section>
{{/SENSOR}}
{{#LEFT_OUT}}
<section class="card">
<h2>Left out</h2>
<ul>
{{#ROBOT_OUT}}<li><a href="../../robots/{{ROBOT}}/">{{ROBOT}}</a>: <span dir="auto">{{WHY}}</span></li>
{{/ROBOT_OUT}}
{{#SENSOR_OUT}}<li><bdi>{{NAME}}</bdi>: its pose is known on {{ROBOTS}} only</li>
{{/SENSOR_OUT}}
</ul>
{{#MORE}}<p class="hint">{{TEXT}}</p>{{/MORE}}
</section>
{{/LEFT_OUT}}
{{#SET}}
<section class="card">
<h2>As it was set <span class="soft">version {{VERSION}}</span></h2>
<p dir="auto">By <bdi>{{WHO}}</bdi> on {{TIME}}: <bdi>{{REASON}}</bdi></p>
<pre><code>{{TEXT}}</code></pre>
</section>
{{/SET}}
{{#NOT_SET}}
<section class="card empty">
<p>Nobody has set this rig model: its sensors, places and pairs are not held against anything. To set it:</p>
<pre><code>rigcal model set FILE --reason TEXT</code></pre>
</section>
{{/NOT_SET}}
</main>
</body>
</html>
