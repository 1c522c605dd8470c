{{%AUTOESCAPE context="HTML"}}
{{>HEAD}}
<body>
<main>
<nav class="crumbs" aria-label="Where you are"><a href="../../">Fleet</a> / <span>{{ROBOT}}</span></nav>
<header>
<h1>{{ROBOT}}</h1>
<p class="meta">{{SUMMARY}}{{#OVERDUE}} <span class="badge fail">overdue</span>{{/OVERDUE}}</p>
</header>
{{>BANNER}}
{{#REVISIONS}}
<section class="card">
<h2 id="revisions">Revisions <span class="soft">newest first</span></h2>
<div class="scroll" tabindex="0" role="region" aria-labelledby="revisions">
<table class="list">
<thead><tr><th scope="col">Revision</th><th scope="col">Verdict</th><th scope="col">Solved</th><th scope="col">Digest</th></tr></thead>
<tbody>
{{#REVISION}}
<tr><th scope="row"><a href="revisions/{{NUMBER}}/">revision {{NUMBER}}</a></th><td class="text"><span class="badge {{LEVEL}}">{{WORD}}</span> <span class="why" dir="auto">{{WHY}}</span></td><td class="text">{{TIME}}<br><span class="soft">{{AGE}}</span></td><td class="text"><code>{{DIGEST}}</code></td></tr>
{{/REVISION}}
</tbody>
</table>
</div>
{{#MORE}}<p class="hint">{{COUNT}} older revisions are kept: <code>rigcal show</code> names them.</p>{{/MORE}}
</section>
{{/REVISIONS}}
</main>
</body>
</html>
