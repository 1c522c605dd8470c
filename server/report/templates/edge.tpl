{{%AUTOESCAPE context="HTML"}}
<details class="card edge {{STATE}}"{{#OPEN}} open{{/OPEN}}>
<summary><h2>{{FROM}} &rarr; {{TO}}</h2> <span class="badge {{LEVEL}}">{{STATE}}</span> <span class="soft"><bdi>{{METHOD}}</bdi></span>{{#WARNED}} <span class="badge warn">{{COUNT}}</span>{{#WORST}} <span class="soft">worst capture {{TEXT}}</span>{{/WORST}}{{/WARNED}}</summary>
<div id="{{ANCHOR}}" class="body">
{{#DIAGNOSES}}
<div class="diagnosis {{LEVEL}}">
{{#DIAGNOSIS}}<p class="what" dir="auto">{{WHAT:x-typed}}</p><p class="cure" dir="auto">{{CURE:x-typed}}</p>
{{/DIAGNOSIS}}
</div>
{{/DIAGNOSES}}
<div class="columns">
{{#POSE}}
<div>
<h3>Pose of {{TO}} in {{FROM}}</h3>
<div class="scroll" tabindex="0" role="region" aria-label="Pose of {{TO}} in {{FROM}}">
<table class="small">
<thead><tr><th scope="col">Axis</th><th scope="col">Position, mm</th><th scope="col">&sigma;, mm</th><th scope="col">Rotation, deg</th><th scope="col">&sigma;, deg</th></tr></thead>
<tbody>
{{#AXIS}}<tr><th scope="row">{{NAME}}</th><td>{{P}}</td><td>{{SP}}</td><td>{{R}}</td><td>{{SR}}</td></tr>
{{/AXIS}}
</tbody>
</table>
</div>
<p class="hint">{{OBSERVABLE}}</p>
</div>
{{/POSE}}
{{#FIGURES}}
<div class="wide">
<h3>What the method says of itself</h3>
<dl class="pairs">
{{#FIGURE}}<div><dt><bdi>{{NAME}}</bdi></dt><dd>{{VALUE}}</dd></div>
{{/FIGURE}}
</dl>
</div>
{{/FIGURES}}
{{#PARTS}}
<div>
<h3>Within &sigma;, besides the captures</h3>
<table class="small">
<thead><tr><th scope="col">From</th><th scope="col">mm</th><th scope="col">deg</th></tr></thead>
<tbody>
{{#PART}}<tr><th scope="row"><bdi>{{NAME}}</bdi></th><td>{{MM}}</td><td>{{DEG}}</td></tr>
{{/PART}}
</tbody>
</table>
</div>
{{/PARTS}}
</div>
<div class="plots" data-edge-charts="{{ANCHOR}}">
{{#CAPTURES}}
<div data-fallback>
<h3>Residual of each capture <span class="soft">rms, {{UNIT}}</span></h3>
<div class="scroll" tabindex="0" role="region" aria-label="Residual of each capture, {{FROM}} to {{TO}}">
{{>BARS}}
</div>
</div>
{{/CAPTURES}}
</div>
{{#CAPTURE_NOTES}}
{{#BARS_CUT}}<p class="hint">{{TEXT}}</p>{{/BARS_CUT}}
{{#NONE_USED}}<p class="hint" dir="auto">{{TEXT}}</p>{{/NONE_USED}}
{{#UNUSED}}<p class="hint" dir="auto"><strong>{{CAPTURE}}</strong> was not used{{#REASON}}: {{NOTE}}{{/REASON}}.</p>
{{/UNUSED}}
{{#LEFT_OUT}}<p class="hint" dir="auto">{{TEXT}}</p>{{/LEFT_OUT}}
{{/CAPTURE_NOTES}}
{{#INFLUENCE}}<p class="hint">{{TEXT}}</p>{{/INFLUENCE}}
{{#PICTURES}}
<h3>Pictures <span class="soft">of captures that were left out first, then of the worst fit</span></h3>
<div class="pictures">
{{#PICTURE}}
<figure>{{#STORED}}<a href="evidence/{{FILE}}"><img loading="lazy" src="evidence/{{FILE}}" alt=""><span dir="auto">{{TITLE}}</span></a>{{/STORED}}{{#MISSING}}<span class="missing">picture not stored</span><figcaption dir="auto">{{TITLE}}</figcaption>{{/MISSING}}</figure>
{{/PICTURE}}
</div>
{{#MORE}}<p class="hint">{{SHOWN}} of {{COUNT}} pictures are shown. {{#SESSION}}<a href="../../sessions/{{ID}}/#captures">All of them are on the page of the session.</a>{{/SESSION}}</p>{{/MORE}}
{{/PICTURES}}
{{#LENS}}
<details class="words">
<summary>Lens values that this edge was solved with</summary>
<dl class="values">{{#FIGURE}}<div><dt><bdi>{{NAME}}</bdi></dt><dd>{{VALUE}}</dd></div>{{/FIGURE}}</dl>
</details>
{{/LENS}}
<p class="hint">{{PROVENANCE}} Edge <code>{{ID}}</code></p>
{{#RETIRE}}<p class="hint">If it is wrong: <code class="typed">{{COMMAND}}</code></p>{{/RETIRE}}
</div>
</details>
