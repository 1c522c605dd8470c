{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../../../">Fleet</a> / <a href="../../">{{ROBOT}}</a> / <span>session {{SHORT}}</span></nav>
<header>
<h1>{{ROBOT}} <span class="soft">session {{SHORT}}</span></h1>
<p class="meta">Captured {{TIME}}{{#OPERATOR}} by <bdi>{{NAME}}</bdi>{{/OPERATOR}}, {{FILES}}{{#CONDITION}}; <bdi>{{NAME}}</bdi>: <bdi>{{VALUE}}</bdi>{{/CONDITION}}</p>
</header>
<div id="live" data-fresh{{#LIVE}} data-live="../../../../api/v1/live?robot={{ROBOT}}"{{/LIVE}}>
{{#ROBOT_NOW}}<p class="working" dir="auto"><a href="../../">{{ROBOT}}</a> now: <span class="badge {{LEVEL}}">{{RULE:x-typed}}</span>{{#WHY}} {{TEXT:x-typed}}{{/WHY}} <a href="../../revisions/{{NUMBER}}/">Report of revision {{NUMBER}}</a></p>{{/ROBOT_NOW}}
<section class="card moved {{OUTCOME_LEVEL}}" aria-label="Outcome">
<p class="what" role="status">{{OUTCOME}}{{#PROGRESS}} <progress value="{{DONE}}" max="{{ALL}}" aria-label="Progress"></progress>{{/PROGRESS}}</p>
{{#DO}}<p dir="auto"><strong>What to do:</strong> {{WHAT_TO_DO:x-typed}}</p>{{/DO}}
{{#LACKING}}<p dir="auto"><span class="badge warn">rig model</span> {{TEXT:x-typed}}</p>
{{/LACKING}}
{{#GONE}}<p dir="auto"><span class="badge unknown">past</span> {{WHY}}; what this session says of it does not count. To bring it back: <code class="typed">{{COMMAND}}</code></p>
{{/GONE}}
{{#BOARD_REMARK}}<p dir="auto"><span class="badge {{LEVEL}}">{{WORD}}</span> {{WHY}}. {{CURE:x-typed}}</p>
{{/BOARD_REMARK}}
</section>
<section class="card">
<h2 id="edges">What it gave{{#FAILED_FIRST}} <span class="soft">failed pairs first</span>{{/FAILED_FIRST}}</h2>
{{#NO_PAIRS}}<p class="soft">Nothing: it has no pair of sensors to calibrate.</p>{{/NO_PAIRS}}
{{#NO_EDGES}}<p class="soft">Nothing yet: a pair of sensors appears here once it was calibrated, or once it is known why it cannot be.</p>{{/NO_EDGES}}
{{#EDGES}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="edges">
<table class="list">
<thead><tr><th scope="col">Pair</th><th scope="col">State</th><th scope="col">Method</th></tr></thead>
<tbody>
{{#EDGE}}<tr><th scope="row">{{FROM}} &rarr; {{TO}}</th><td class="text"><span class="badge {{LEVEL}}">{{STATE}}</span> <span class="why" dir="auto">{{WHY:x-typed}}</span>{{#CURE}} <span class="cure" dir="auto">{{TEXT:x-typed}}</span>{{/CURE}}</td><td class="text whole"><bdi>{{METHOD}}</bdi>{{#RETIRE}}<details class="words"><summary>If it is wrong</summary><code class="typed">{{COMMAND}}</code></details>{{/RETIRE}}</td></tr>
{{/EDGE}}
</tbody>
</table>
</div>
{{/EDGES}}
</section>
<section class="card">
<h2 id="captures">Captures <span class="soft">who saw what, and whether it was used</span></h2>
{{#SHEET}}
<div class="scroll" tabindex="0" role="region" aria-labelledby="captures">
<table class="sheet">
<thead><tr><th scope="col">Capture</th><th scope="col">Used by</th>{{#SENSOR}}<th scope="col"><bdi>{{NAME}}</bdi></th>{{/SENSOR}}</tr></thead>
<tbody>
{{#CAPTURE}}<tr><th scope="row"><bdi>{{NAME}}</bdi></th><td class="text">{{#USES}}<details{{#OPEN}} open{{/OPEN}}><summary>{{USED}}</summary>{{#USE}}<p><span class="badge {{LEVEL}}">{{WORD}}</span> {{FROM}} &rarr; {{TO}}{{#NOTE}} <span class="soft" dir="auto">{{TEXT}}</span>{{/NOTE}}</p>{{/USE}}</details>{{/USES}}</td>{{#CELL}}<td>{{#PICTURE}}<a href="evidence/{{FILE}}"><img loading="lazy" decoding="async" width="160" height="120" src="evidence/{{FILE}}" alt="{{ALT}}"></a><span class="alt" dir="auto">{{#USED}}<span class="used">used</span>: {{/USED}}{{FOUND}}{{#UNUSED}}<br><span class="unused">not used</span>: {{WHY}}{{/UNUSED}}</span>{{/PICTURE}}{{#UNREADABLE}}<span class="alt" dir="auto"><span class="unused">not readable</span>: {{WHY}}</span>{{/UNREADABLE}}{{#BLANK}}<span class="soft">{{TEXT}}</span>{{/BLANK}}</td>{{/CELL}}</tr>
{{/CAPTURE}}
</tbody>
</table>
</div>
{{/SHEET}}
{{#PART_OF}}<p class="hint"><bdi>{{NAME}}</bdi>:{{#SERIAL}} serial <bdi>{{TEXT}}</bdi>{{/SERIAL}}{{#FIRMWARE}} firmware <bdi>{{TEXT}}</bdi>{{/FIRMWARE}}</p>
{{/PART_OF}}
{{#POSES}}<p class="hint">The poses of <bdi>{{NAMES}}</bdi> come as one file per sensor, of the whole session.</p>{{/POSES}}
{{#MORE}}<p class="hint">{{COUNT}} more captures are in the session's manifest.</p>{{/MORE}}
<p class="hint"><a href="../../../../api/v1/session?id={{ID}}">Manifest as JSON</a> <code>{{ID}}</code></p>
{{#MISLEADS}}<p class="hint">If this session misleads: <code class="typed">{{COMMAND}}</code></p>{{/MISLEADS}}
</section>
</div>
</main>
{{#SCRIPT}}<script defer src="{{PATH}}"></script>
{{/SCRIPT}}
</body>
</html>
