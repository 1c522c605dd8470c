{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="found" data-part="As found">As found, as left <span class="soft"><a href="../../sessions/{{SESSION}}/">the newest session</a> against what was in use</span></h2>
<p dir="auto">{{TEXT}}</p>
{{#TABLE}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="found">
<table class="small">
<thead><tr><th scope="col">Sensor</th><th scope="col" class="text">Axis</th><th scope="col">As found:<br>off by</th><th scope="col">in &sigma;</th><th scope="col">As left:<br>off by</th><th scope="col">in &sigma;</th><th scope="col" class="sigma">&sigma;</th><th scope="col">Smallest change<br>seen</th>{{#RATE_HEAD}}<th scope="col">Change in<br>30 days</th>{{/RATE_HEAD}}</tr></thead>
<tbody>
{{#ROW}}<tr>{{#SENSOR}}<th scope="row" rowspan="{{ROWS}}"><bdi>{{NAME}}</bdi><br><span class="badge {{LEVEL}}">{{STATE}}</span>{{#OR}}<br><span class="soft">or <bdi>{{NAME}}</bdi></span>{{/OR}}</th>{{/SENSOR}}{{#TESTED}}<td class="text">{{AXIS}}</td>{{#OPEN}}<td class="text soft" colspan="6">not measured</td>{{/OPEN}}{{#MEASURED}}{{#FOUND}}<td>{{OFF}}</td><td>{{#COLOURED}}<span class="badge {{CLASS}}">{{SIGMAS}}</span>{{/COLOURED}}{{#PLAIN}}{{SIGMAS}}{{/PLAIN}}</td>{{/FOUND}}{{#LEFT}}<td>{{OFF}}</td><td>{{#COLOURED}}<span class="badge {{CLASS}}">{{SIGMAS}}</span>{{/COLOURED}}{{#PLAIN}}{{SIGMAS}}{{/PLAIN}}</td>{{/LEFT}}{{#GONE}}<td class="text soft" colspan="2">has no pose any more</td>{{/GONE}}<td class="sigma">{{SIGMA}}</td><td>{{SMALLEST}}</td>{{#RATE}}<td>{{TEXT}}</td>{{/RATE}}{{/MEASURED}}{{/TESTED}}{{#UNTESTED}}<td class="text soft" colspan="7">not tested</td>{{/UNTESTED}}</tr>
{{/ROW}}
</tbody>
</table>
</div>
{{#MORE}}<p class="hint">{{COUNT}}: <code>rigcal show {{ROBOT}} --json</code> has them.</p>{{/MORE}}
<p class="hint">Before the update, the calibration in use is held against what the session by itself says; after it, the poses of this page are. Seen from <bdi>{{FRAME}}</bdi>, along and about each sensor's own axes. &sigma; is that of the change as found, with what sensors scatter by from visit to visit. A sensor has drifted where the change is more than chance: a session in which nothing moved accuses any of them with odds of {{ODDS}} %. The smallest change seen would have been told with 95 %.{{#RATE_NOTE}} The change in 30 days is a line through the visits that are kept.{{/RATE_NOTE}}</p>
{{/TABLE}}
</section>
